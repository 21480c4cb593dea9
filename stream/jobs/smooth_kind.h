#pragma once
// Smoothing as a kind of job: normals where they are needed and missing, then the projection.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stream/jobs/job_kind.h"
#include "stream/jobs/smooth.h"
#include "stream/operators/project.h"

namespace pss {

class SmoothKind : public JobKind {
 public:
  /// Requires: `job` outlives this.
  explicit SmoothKind(const SmoothJob& job);

  std::string_view command() const override { return "smooth"; }
  nlohmann::json parameters() const override;
  PassNames passes() const override;
  Result<void> check() const override;
  Result<void> check_source(const Schema& source) const override;
  Result<Schema> result_schema(const Schema& source) const override;
  std::uint64_t measuring_memory() const override;
  Result<std::optional<Pass>> next(PassContext& job) override;
  void remember(nlohmann::ordered_json& summary) const override;
  void recall(const nlohmann::ordered_json& summary) override;
  Result<void> look_at(const Store& result, JobReport& report) override;
  std::vector<StoreShape> expect(const StoreHeader& source) override;
  double seconds_per_point() const override;

  const SmoothChoices& choices() const { return choices_; }
  const ProjectStatistics& statistics() const { return statistics_; }

 private:
  Result<Pass> first(PassContext& job);
  Result<void> choose_widths_for(const Source& source, PassContext& job);
  ProjectParameters parameters_for(const PassContext& job) const;
  Result<ProjectOperator> normals_of(const Source& source, const PassContext& job) const;
  Result<ProjectOperator> projection_of(const Source& source, const PassContext& job) const;
  Result<Pass> projection(std::unique_ptr<const PassSource> source, const PassContext& job) const;
  /// No point moves farther than it looks.
  double largest_move() const;

  const SmoothJob& job_;
  SmoothChoices choices_;
  ProjectStatistics statistics_;
};

}  // namespace pss
