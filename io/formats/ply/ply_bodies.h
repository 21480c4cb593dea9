#pragma once
// What follows a PLY header, and the two ways to read it: numbers as text, numbers as bytes.

#include <cstdint>
#include <memory>

#include "core/result.h"
#include "io/file/byte_source.h"
#include "io/formats/ply/ply_header.h"
#include "io/formats/ply/ply_layout.h"
#include "io/points/points.h"
#include "io/points/reader.h"

namespace pss {

/// An open PLY file whose header is read.
struct PlyFile {
  ByteSource bytes;        ///< at the first byte behind the header
  std::uint64_t size = 0;  ///< of the file
  PlyHeader header;
  std::size_t vertex = 0;  ///< its place among the elements
  PlyLayout layout;
  CloudHeader cloud;

  const PlyElement& vertices() const { return header.elements[vertex]; }
};

/// What both kinds of reader share: which vertex comes next, how many there are.
class PlyReader : public Reader {
 public:
  const CloudHeader& header() const final { return file_.cloud; }
  Result<void> read(std::size_t max, PointBatch& batch) final;
  Result<void> seek(std::uint64_t record) final;

 protected:
  explicit PlyReader(PlyFile file) : file_(std::move(file)) {}

  /// Reads the vertices next(), next() + 1, ... into a batch that has the room for them.
  virtual Result<void> fill(PointBatch& batch) = 0;
  /// Goes to a vertex that exists, or behind the last one.
  virtual Result<void> go_to(std::uint64_t record) = 0;

  PlyFile& file() { return file_; }
  std::uint64_t next() const { return next_; }
  /// kBadInput: the file ends within vertex `record`.
  Error short_of(std::uint64_t record) const;

 private:
  PlyFile file_;
  std::uint64_t next_ = 0;
};

/// Errors: kBadInput where the elements before the vertices, or the vertices, cannot all be there.
Result<std::unique_ptr<Reader>> read_ply_text(PlyFile file);
Result<std::unique_ptr<Reader>> read_ply_bytes(PlyFile file);

}  // namespace pss
