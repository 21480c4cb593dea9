#include "stream/jobs/output_clash.h"

#include <fmt/format.h>

#include <utility>

#include "io/inputs.h"
#include "io/points/reader.h"
#include "io/points/writer.h"
#include "stream/jobs/smooth_job.h"
#include "stream/passes/outputs.h"
#include "stream/store/export.h"

namespace pss {
namespace {

/// The input that has an attribute of this name.
Result<std::string> owner_of(const SmoothJob& job, const std::string& attribute) {
  for (const std::string& input : job.inputs) {
    if (is_store_input(job)) return input;
    PSS_ASSIGN(const auto reader, open_reader_holding(HeadBytes::kLeft, input));
    if (reader->header().schema.dimension(attribute)) return input;
  }
  return job.inputs.front();
}

Result<void> check_names(const SmoothJob& job, const Schema& source) {
  const std::vector<OutputClash> clashes = clashes_of(source, job.options.outputs);
  if (clashes.empty() || job.options.replace_attributes) return {};
  const OutputClash& clash = clashes.front();
  PSS_ASSIGN(const std::string owner, owner_of(job, clash.attribute));
  return Error{Fault::kUsage,
               fmt::format("{}: has an attribute {} already, whose place the {} of --outputs {} "
                           "would take; leave {} out of --outputs, or add --replace-attributes",
                           owner, clash.attribute, clash.output, clash.word, clash.word)};
}

/// The head that the output would carry on, of the first input or the store.
Result<std::optional<Carry>> head_for(const SmoothJob& job, Format format) {
  if (is_store_input(job)) {
    PSS_ASSIGN(const Store store, Store::open(job.inputs.front()));
    return store.complete() ? carried_head(store, format) : std::optional<Carry>();
  }
  PSS_ASSIGN(const auto reader, open_reader_holding(HeadBytes::kKept, job.inputs.front()));
  return std::optional(reader->header().carry);
}

/// Whether a file of the output's format can hold all attributes, as far as that is known before
/// there are points.
Result<void> check_file(const SmoothJob& job, const StoreHeader& source, const Schema& result) {
  if (is_store_name(job.output)) return {};
  WriteOptions options;
  PSS_ASSIGN(options.format, format_for(job.output));
  options.schema = result;
  options.grid = source.lattice;
  PSS_ASSIGN(options.carry, head_for(job, options.format));
  return check_writable(job.output, std::move(options));
}

}  // namespace

Result<void> check_attributes(const SmoothJob& job, const StoreHeader& source) {
  PSS_TRY(check_names(job, source.schema));
  Schema result = source.schema;
  PSS_TRY(OutputColumns::add_to(result, job.options.outputs));
  if (result.row_size() <= kMaxRowSize) return check_file(job, source, result);
  return Error{Fault::kBadInput,
               fmt::format("{}: found {} bytes of attributes a point, with --outputs, expected at "
                           "most {}; leave some of --outputs out",
                           job.inputs.front(), result.row_size(), kMaxRowSize)};
}

}  // namespace pss
