#pragma once
// What a point carries besides its position: named fields in a fixed-size row of bytes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace pss {

enum class Type : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
};

std::size_t size_of(Type type);
const char* type_name(Type type);  ///< "int8", "uint8", ... "float64"
bool is_float(Type type);

/// A named part of an integer field, as LAS packs several values into a byte.
struct BitField {
  std::string name;
  std::uint8_t shift = 0;
  std::uint8_t width = 0;

  bool operator==(const BitField&) const = default;
};

/// A column of the row: `count` values of one type, little-endian.
///
/// The value a person means is scale * stored + offset. A field with bits is a container: its
/// values are its bit fields, and its own name is only for storage.
struct Field {
  std::string name;
  Type type = Type::kUint8;
  std::uint32_t count = 1;
  double scale = 1;
  double offset = 0;
  std::vector<BitField> bits;

  std::size_t size() const { return size_of(type) * count; }
  bool operator==(const Field&) const = default;
};

/// One value of a point by name, wherever it lies in the row.
struct Dimension {
  std::string name;
  Type type = Type::kUint8;
  std::uint32_t count = 1;
  double scale = 1;
  double offset = 0;
  std::size_t position = 0;  ///< byte in the row
  std::uint8_t shift = 0;    ///< within the value, for a bit field
  std::uint8_t width = 0;    ///< bits; 0: the whole value
};

/// The fields of a row in order. Names are the field's: Intensity, ReturnNumber, GpsTime, Red...
class Schema {
 public:
  Schema() = default;
  explicit Schema(std::vector<Field> fields);

  const std::vector<Field>& fields() const { return fields_; }
  std::size_t row_size() const { return row_size_; }
  std::size_t position(std::size_t field) const { return positions_[field]; }

  void add(Field field);
  std::optional<std::size_t> find(std::string_view field_name) const;

  /// Every value in row order: a field without bits is one dimension, one with bits several.
  std::vector<Dimension> dimensions() const;
  std::optional<Dimension> dimension(std::string_view name) const;

  bool operator==(const Schema& other) const { return fields_ == other.fields_; }

 private:
  std::vector<Field> fields_;
  std::vector<std::size_t> positions_;
  std::size_t row_size_ = 0;
};

/// The value of an element of a dimension, scale and offset applied.
double read_value(const Dimension& dimension, const std::byte* row, std::size_t element = 0);
/// Writes a value, scale and offset removed, rounded and clamped to what the dimension can hold.
void write_value(const Dimension& dimension, std::byte* row, double value, std::size_t element = 0);

/// A schema that holds every dimension of both: the fields of `a`, then what only `b` has.
///
/// A dimension that both have gets a type, width and scale that hold the values of both; a bit
/// field that needs more bits than its container has for it becomes a field of its own.
Schema unite(const Schema& a, const Schema& b);

/// Rewrites rows of one schema as rows of another, matching dimensions by name.
///
/// What the target lacks is dropped, what the source lacks is zero; integers of 64 bits stay exact.
/// A target with another scale or type gets the nearest value that it can hold (integers: NaN is
/// 0).
class RowMapper {
 public:
  RowMapper(const Schema& from, const Schema& to);

  /// Names of source dimensions that the target cannot hold at all.
  const std::vector<std::string>& dropped() const { return dropped_; }
  /// Names of dimensions that are rounded, or clamped to a narrower range, on their way.
  const std::vector<std::string>& narrowed() const { return narrowed_; }
  bool identity() const { return identity_; }

  /// Shape: `from` has n rows of the source schema, `to` n rows of the target.
  void map(std::span<const std::byte> from, std::span<std::byte> to) const;

 private:
  struct Copy {  ///< bytes that go over unchanged
    std::size_t from, to, size;
  };
  struct Convert {
    Dimension from, to;
  };
  void add_copy(const Copy& copy);
  void add_convert(const Schema& from, const Schema& to, const std::string& name);

  std::size_t from_size_ = 0;
  std::size_t to_size_ = 0;
  bool identity_ = false;
  std::vector<Copy> copies_;
  std::vector<Convert> converts_;
  std::vector<std::string> dropped_;
  std::vector<std::string> narrowed_;
};

}  // namespace pss
