#include "stream/jobs/attributes.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "io/inputs.h"
#include "io/open.h"
#include "stream/store/export.h"
#include "stream/store/input_table.h"

namespace pss {
namespace {

/// The input that has an attribute of this name.
Result<std::string> owner_of(const JobRequest& request, const std::string& attribute) {
  for (const std::string& input : request.inputs) {
    if (is_store_input(request)) return input;
    PSS_ASSIGN(const auto reader, open_reader_holding(HeadBytes::kLeft, input));
    if (reader->header().schema.dimension(attribute)) return input;
  }
  return request.inputs.front();
}

/// The head that the output would carry on: of the first input, or of that of a complete store.
Result<std::optional<Carry>> head_for(const JobRequest& request, const StoreHeader& source,
                                      const Format& format) {
  const std::string& input = request.inputs.front();
  if (!is_store_input(request)) {
    PSS_ASSIGN(const auto reader, open_reader_holding(HeadBytes::kKept, input));
    return std::optional(reader->header().carry);
  }
  if (source.inputs.count == 0) return std::optional<Carry>();
  PSS_ASSIGN(const InputTable inputs, InputTable::open(input, source.inputs.count));
  return carried_head(inputs, format);
}

/// Whether a file of the output's format can hold all attributes, as far as that is known before
/// there are points.
Result<void> check_file(const JobRequest& request, const StoreHeader& source,
                        const Schema& result) {
  PSS_ASSIGN(const Format* format, sink_of(request));
  if (!format) return {};
  WriteOptions options;
  options.schema = result;
  options.grid = source.lattice;
  PSS_ASSIGN(options.carry, head_for(request, source, *format));
  return check_writable(request.output, std::move(options));
}

}  // namespace

Result<void> check_attributes(const JobRequest& request, const JobKind& kind,
                              const StoreHeader& source) {
  PSS_TRY(kind.check_source(source.schema));
  PSS_ASSIGN(const Schema result, kind.result_schema(source.schema));
  if (result.row_size() <= kMaxRowSize) return check_file(request, source, result);
  return Error{Fault::kBadInput,
               fmt::format("{}: found {} bytes of attributes a point, with --outputs, expected at "
                           "most {}; leave some of --outputs out",
                           request.inputs.front(), result.row_size(), kMaxRowSize)};
}

Result<void> check_clashes(const JobRequest& request, const Schema& source, OutputSet outputs) {
  const std::vector<OutputClash> clashes = clashes_of(source, outputs);
  if (clashes.empty()) return {};
  const OutputClash& clash = clashes.front();
  PSS_ASSIGN(const std::string owner, owner_of(request, clash.attribute));
  return Error{Fault::kUsage,
               fmt::format("{}: has an attribute {} already, whose place the {} of --outputs {} "
                           "would take; leave {} out of --outputs, or add --replace-attributes",
                           owner, clash.attribute, clash.output, clash.word, clash.word)};
}

}  // namespace pss
