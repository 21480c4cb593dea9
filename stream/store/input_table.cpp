#include "stream/store/input_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/file/file.h"
#include "io/formats/table.h"
#include "stream/store/bytes.h"
#include "stream/store/lattice_bytes.h"

namespace pss {
namespace {

/// An entry is a record of facts, then one of its coordinate system and one of its head, each where
/// it has any.
enum class Part : std::uint32_t { kTable = 1, kFacts = 2, kCrs = 3, kHead = 4 };

constexpr std::size_t kPiece = 256 << 10;

std::uint32_t type_of(Part part) { return static_cast<std::uint32_t>(part); }

void put(ByteWriter& w, const InputRecord& record) {
  w.text(record.path);
  w.put(record.size);
  w.put(record.modified_ns);
  w.put(record.content_hash);
}

InputRecord get_record(ByteReader& r) {
  InputRecord record;
  record.path = r.text();
  record.size = r.get<std::uint64_t>();
  record.modified_ns = r.get<std::int64_t>();
  record.content_hash = r.get<std::uint64_t>();
  return record;
}

std::vector<std::byte> encode(const InputFacts& facts) {
  std::vector<std::byte> out;
  ByteWriter w(out);
  put(w, facts.record);
  w.text(facts.format);
  w.put<std::uint8_t>(facts.grid.has_value());
  if (facts.grid) put_lattice(w, *facts.grid);
  w.put(facts.counts.read);
  w.put(facts.counts.not_finite);
  w.put(facts.counts.outside);
  w.put(facts.counts.moved);
  return out;
}

std::optional<InputFacts> decode_facts(std::span<const std::byte> payload) {
  ByteReader r(payload);
  InputFacts facts;
  facts.record = get_record(r);
  facts.format = r.text();
  if (r.get<std::uint8_t>() != 0) facts.grid = get_lattice(r);
  facts.counts.read = r.get<std::uint64_t>();
  facts.counts.not_finite = r.get<std::uint64_t>();
  facts.counts.outside = r.get<std::uint64_t>();
  facts.counts.moved = r.get<std::uint64_t>();
  return r.finished() ? std::optional(std::move(facts)) : std::nullopt;
}

std::vector<std::byte> encode(const Carry& carry) {
  std::vector<std::byte> out;
  out.reserve(2 * sizeof(std::uint32_t) + carry.head.size() + carry.tail.size());
  ByteWriter w(out);
  w.bytes(carry.head);
  w.bytes(carry.tail);
  return out;
}

/// The digest of inputs, one after the other.
class Digester {
 public:
  void add(const InputRecord& record) {
    std::vector<std::byte> bytes;
    ByteWriter w(bytes);
    put(w, record);
    hash_.update(bytes);
    ++count_;
  }
  InputsDigest digest() const { return {count_, hash_.digest()}; }

 private:
  StreamHash hash_;
  std::uint64_t count_ = 0;
};

/// Whether a part may stand behind another one; the first is the table's own.
bool may_follow(std::uint32_t part, std::uint32_t before) {
  if (before == 0) return part == type_of(Part::kTable);
  if (part == type_of(Part::kFacts)) return true;
  const bool of_entry = part == type_of(Part::kCrs) || part == type_of(Part::kHead);
  return of_entry && before >= type_of(Part::kFacts) && before < part;
}

Result<void> copy_bytes(const File& from, std::uint64_t size, File& to) {
  std::vector<std::byte> piece(kPiece);
  for (std::uint64_t at = 0; at < size; at += kPiece) {
    const auto part = std::span(piece).first(std::min<std::uint64_t>(kPiece, size - at));
    PSS_TRY(from.read(at, part));
    PSS_TRY(to.write(at, part));
  }
  return {};
}

}  // namespace

InputsDigest digest_of(std::span<const InputRecord> inputs) {
  Digester digester;
  for (const InputRecord& input : inputs) digester.add(input);
  return digester.digest();
}

std::string inputs_path(const std::string& store) { return store + "/inputs"; }

Result<InputTable> InputTable::open(const std::string& store, std::optional<std::uint64_t> count) {
  PSS_ASSIGN(LogFile file, LogFile::open(inputs_path(store)));
  InputTable table(std::move(file));
  PSS_TRY(table.find_entries(count));
  return table;
}

Error InputTable::damaged(std::uint64_t offset, const std::string& what) const {
  return {Fault::kBadInput,
          fmt::format("{}: damaged at offset {}: {}", file_.path(), offset, what)};
}

Result<void> InputTable::find_entries(std::optional<std::uint64_t> count) {
  std::uint32_t before = 0;  // no part
  for (std::uint64_t offset = LogFile::kFirst; offset < file_.size();) {
    PSS_ASSIGN(const LogPlace place, file_.at(offset));
    if (!may_follow(place.type, before))
      return damaged(offset, fmt::format("a record of type {} makes no sense there", place.type));
    if (place.type == type_of(Part::kFacts)) entries_.push_back(offset);
    before = place.type;
    offset = place.end();
  }
  PSS_ASSIGN(const LogPlace first, file_.at(LogFile::kFirst));
  PSS_ASSIGN(const std::vector<std::byte> payload, file_.payload(first));
  const auto promised = ByteReader(payload).get<std::uint64_t>();
  if (promised == entries_.size() && count.value_or(promised) == promised) return {};
  return damaged(file_.size(), fmt::format("{} inputs found, {} expected", entries_.size(),
                                           count.value_or(promised)));
}

Result<InputFacts> InputTable::facts(std::size_t input) const {
  PSS_ASSIGN(const LogPlace place, file_.at(entries_[input]));
  PSS_ASSIGN(const std::vector<std::byte> payload, file_.payload(place));
  auto facts = decode_facts(payload);
  if (!facts) return damaged(place.offset, "the record of an input makes no sense");
  return *std::move(facts);
}

/// The part of an entry that has this type, where it has one.
Result<std::optional<LogPlace>> InputTable::part_of(std::size_t input, std::uint32_t type) const {
  PSS_ASSIGN(LogPlace place, file_.at(entries_[input]));
  while (place.end() < file_.size()) {
    PSS_ASSIGN(place, file_.at(place.end()));
    if (place.type == type) return std::optional(place);
    if (place.type == type_of(Part::kFacts)) break;
  }
  return std::optional<LogPlace>();
}

Result<std::uint64_t> InputTable::head_size(std::size_t input) const {
  std::uint64_t bytes = 0;
  for (const Part part : {Part::kCrs, Part::kHead}) {
    PSS_ASSIGN(const std::optional<LogPlace> place, part_of(input, type_of(part)));
    bytes += place ? place->size : 0;
  }
  return bytes;
}

Result<std::string> InputTable::crs(std::size_t input) const {
  PSS_ASSIGN(const std::optional<LogPlace> place, part_of(input, type_of(Part::kCrs)));
  if (!place) return std::string();
  PSS_ASSIGN(const std::vector<std::byte> payload, file_.payload(*place));
  return std::string(reinterpret_cast<const char*>(payload.data()), payload.size());
}

Result<std::optional<Carry>> InputTable::head(std::size_t input) const {
  PSS_ASSIGN(const InputFacts facts, this->facts(input));
  const Format* format = find_format(facts.format);
  PSS_ASSIGN(const std::optional<LogPlace> place, part_of(input, type_of(Part::kHead)));
  if (!format || !place) return std::optional<Carry>();
  PSS_ASSIGN(const std::vector<std::byte> payload, file_.payload(*place));
  ByteReader r(payload);
  const auto head = r.bytes();
  const auto tail = r.bytes();
  if (!r.finished()) return damaged(place->offset, "the head of an input makes no sense");
  return std::optional(
      Carry{std::string(format->family), {head.begin(), head.end()}, {tail.begin(), tail.end()}});
}

Result<InputsDigest> InputTable::check() const {
  Digester digester;
  std::size_t input = 0;
  for (std::uint64_t offset = LogFile::kFirst; offset < file_.size();) {
    PSS_ASSIGN(const LogPlace place, file_.at(offset));
    PSS_TRY(file_.check(place));
    if (place.type == type_of(Part::kFacts)) {
      PSS_ASSIGN(const InputFacts facts, this->facts(input++));
      digester.add(facts.record);
    }
    offset = place.end();
  }
  return digester.digest();
}

Result<InputTableWriter> InputTableWriter::create(const std::string& store, std::uint64_t count) {
  std::vector<std::byte> payload;
  ByteWriter(payload).put(count);
  PSS_ASSIGN(LogWriter log, LogWriter::create(inputs_path(store), type_of(Part::kTable), payload));
  return InputTableWriter(std::move(log));
}

Result<void> InputTableWriter::add(const InputFacts& facts, std::string_view crs,
                                   const Carry& carry) {
  PSS_TRY(log_.append(type_of(Part::kFacts), encode(facts)));
  if (!crs.empty()) PSS_TRY(log_.append(type_of(Part::kCrs), std::as_bytes(std::span(crs))));
  if (carry.head.empty() && carry.tail.empty()) return {};
  return log_.append(type_of(Part::kHead), encode(carry));
}

Result<void> copy_inputs(const std::string& from, const std::string& to) {
  PSS_ASSIGN(const InputTable table, InputTable::open(from));
  PSS_TRY(table.check());
  PSS_ASSIGN(const File source, File::open(inputs_path(from)));
  PSS_ASSIGN(File copy, File::create_anew(inputs_path(to)));
  PSS_TRY(copy_bytes(source, table.bytes(), copy));
  PSS_TRY(copy.sync());
  return sync_directory(to);
}

}  // namespace pss
