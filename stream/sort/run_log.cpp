#include "stream/sort/run_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/file/file.h"
#include "stream/store/bytes.h"

namespace pss {
namespace {

enum class Kind : std::uint32_t { kPlan = 1, kRun = 2, kMerged = 3 };

std::string log_path(const std::string& folder) { return folder + "/log"; }

void put(ByteWriter& w, const RunInfo& run) {
  w.put(run.id);
  w.put(run.points);
  w.put(run.blocks);
  w.put(run.data_size);
}

/// More than any run has, and so few that sizes made of it do not overflow.
constexpr std::uint64_t kMost = std::uint64_t{1} << 56;

RunInfo get_run(ByteReader& r) {
  RunInfo run;
  run.id = r.get<std::uint64_t>();
  run.points = r.get<std::uint64_t>();
  run.blocks = r.get<std::uint64_t>();
  run.data_size = r.get<std::uint64_t>();
  if (run.id > kMost || run.blocks > run.points || run.points > kMost || run.data_size > kMost)
    r.fail();
  return run;
}

void put(ByteWriter& w, const IngestSummary& s) {
  w.put(s.points_read);
  w.put(s.dropped_not_finite);
  w.put(s.dropped_outside);
  w.put(s.moved_to_lattice);
  w.put(s.largest_move);
  w.put(s.read_seconds);
}

IngestSummary get_summary(ByteReader& r) {
  IngestSummary s;
  s.points_read = r.get<std::uint64_t>();
  s.dropped_not_finite = r.get<std::uint64_t>();
  s.dropped_outside = r.get<std::uint64_t>();
  s.moved_to_lattice = r.get<std::uint64_t>();
  s.largest_move = r.get<double>();
  s.read_seconds = r.get<double>();
  return s;
}

void put(ByteWriter& w, const InputCounts& counts) {
  w.put(counts.read);
  w.put(counts.not_finite);
  w.put(counts.outside);
  w.put(counts.moved);
}

InputCounts get_counts(ByteReader& r) {
  InputCounts counts;
  counts.read = r.get<std::uint64_t>();
  counts.not_finite = r.get<std::uint64_t>();
  counts.outside = r.get<std::uint64_t>();
  counts.moved = r.get<std::uint64_t>();
  return counts;
}

Error other_plan(const std::string& folder) {
  return {Fault::kFailed, fmt::format("{}: holds the runs of other inputs or parameters; use "
                                      "--restart",
                                      folder)};
}

/// The number of inputs that are read up to a cursor, in part or whole.
std::uint64_t inputs_up_to(const Cursor& cursor, std::uint64_t inputs) {
  return std::min(cursor.input + 1, inputs);
}

}  // namespace

bool has_runs(const std::string& folder) {
  bool any = false;
  const auto see = [&](const LogRecord& record) {
    any = any || static_cast<Kind>(record.type) != Kind::kPlan;
    return Result<void>();
  };
  if (!exists(log_path(folder))) return false;
  return !read_log(log_path(folder), Tail::kMayBeTorn, see) || any;  // a damaged log is no reason
}

Result<void> remove_runs(const std::string& folder) {
  return remove_own_directory(folder, [](const std::string& name) {
    return name == "log" || name == replacement_of("log") || is_run_name(name);
  });
}

Result<RunLog> RunLog::open(const std::string& folder, const StoreHeader& header) {
  RunLog log;
  log.folder_ = folder;
  log.state_.counts.resize(header.inputs.count);
  PSS_TRY(make_directories(directory_of(folder)));
  PSS_TRY(make_own_directory(folder));
  if (!exists(log_path(folder))) {
    PSS_ASSIGN(LogWriter writer,
               LogWriter::create(log_path(folder), static_cast<std::uint32_t>(Kind::kPlan),
                                 encode_header(header)));
    log.log_ = std::move(writer);
    return log;
  }
  PSS_ASSIGN(LogWriter writer, LogWriter::open(log_path(folder), [&](const LogRecord& r) {
               return log.visit(r, header);
             }));
  log.log_ = std::move(writer);
  PSS_TRY(log.remove_merged());
  return log;
}

Result<void> RunLog::visit(const LogRecord& record, const StoreHeader& header) {
  const auto kind = static_cast<Kind>(record.type);
  if (kind == Kind::kPlan)
    return is_encoded(header, record.payload) ? Result<void>() : other_plan(folder_);
  ByteReader reader(record.payload);
  const RunInfo run = get_run(reader);
  if (kind == Kind::kRun) {
    read_cursor(reader);
    state_.runs.push_back(run);
    state_.next_id = run.id + 1;
    if (reader.finished()) return {};
  }
  if (kind == Kind::kMerged) {
    const auto count = reader.get<std::uint64_t>();
    if (reader.finished() && count <= state_.runs.size()) {
      replace_in_state(count, run);
      return {};
    }
  }
  return Error{Fault::kBadInput, fmt::format("{}: damaged at offset {}: the record makes no sense; "
                                             "use --restart",
                                             log_path(folder_), record.offset)};
}

/// How far a run reaches, and the counts of the inputs that it is of.
void RunLog::read_cursor(ByteReader& reader) {
  const std::uint64_t first = state_.cursor.input;
  state_.cursor.input = reader.get<std::uint64_t>();
  state_.cursor.record = reader.get<std::uint64_t>();
  state_.summary = get_summary(reader);
  if (state_.cursor.input < first || state_.cursor.input > state_.counts.size())
    return reader.fail();
  for (std::uint64_t i = first; i < inputs_up_to(state_.cursor, state_.counts.size()); ++i)
    state_.counts[i] = get_counts(reader);
}

void RunLog::replace_in_state(std::size_t count, const RunInfo& run) {
  const auto end = state_.runs.begin() + static_cast<std::ptrdiff_t>(count);
  merged_.insert(merged_.end(), state_.runs.begin(), end);
  state_.runs.erase(state_.runs.begin(), end);
  state_.runs.push_back(run);
  state_.next_id = run.id + 1;
}

/// Only once the record of the merged run is durable: a power cut could leave neither.
Result<void> RunLog::remove_merged() {
  for (const RunInfo& run : merged_) PSS_TRY(remove_file(run_path(folder_, run.id)));
  merged_.clear();
  return {};
}

Result<void> RunLog::add(const RunInfo& run, const Cursor& cursor, const IngestSummary& summary,
                         std::span<const InputCounts> counts) {
  std::vector<std::byte> payload;
  ByteWriter writer(payload);
  put(writer, run);
  writer.put(cursor.input);
  writer.put(cursor.record);
  put(writer, summary);
  for (std::uint64_t i = state_.cursor.input; i < inputs_up_to(cursor, counts.size()); ++i)
    put(writer, counts[i]);
  PSS_TRY(log_->append(static_cast<std::uint32_t>(Kind::kRun), payload));
  PSS_TRY(log_->sync());
  state_.cursor = cursor;
  state_.summary = summary;
  state_.counts.assign(counts.begin(), counts.end());
  state_.runs.push_back(run);
  state_.next_id = run.id + 1;
  return {};
}

Result<void> RunLog::replace(std::size_t count, const RunInfo& run) {
  std::vector<std::byte> payload;
  ByteWriter writer(payload);
  put(writer, run);
  writer.put(static_cast<std::uint64_t>(count));
  PSS_TRY(log_->append(static_cast<std::uint32_t>(Kind::kMerged), payload));
  PSS_TRY(log_->sync());
  replace_in_state(count, run);
  return remove_merged();
}

}  // namespace pss
