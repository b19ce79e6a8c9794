// The features that the scorer knows, and what each of them weighs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "labelling/team_tables.hpp"

namespace explicable {

// The templates of features.py, in its order.
enum class Template : int {
    kStep,
    kAfter,
    kBefore,
    kSameAfter,
    kSameBefore,
    kSameHuman,
    kUndoes,
    kReturns,
    kUnbelieved,
    kRequestMental,
    kRequestOwn,
    kGoalMental,
    kGoalOwn,
    kMission,
    kRequestModels,
    kRequestMission,
    kTrend,
    kOutlook,
};
inline constexpr int kNumTemplates = 18;
inline constexpr int kMaxValues = 4;

// What stands beside a step: the progress of a robot's step, or one of these.
inline constexpr int kHumanStep = kNumProgress;
inline constexpr int kNothing = kNumProgress + 1;
inline constexpr int kNumNeighbours = kNumProgress + 2;

// How much more each feature speaks for "inexplicable" than for "explicable": a dense table for each template.
class FeatureWeights {
public:
    // `unfamiliar`: of each feature that is not set, if its template says something of every step.
    FeatureWeights(int num_schemas, std::size_t max_arity, double unfamiliar);
    // Throws std::invalid_argument if a value does not fit its template.
    void set(int feature_template, std::span<const std::int32_t> values, double weight);
    const std::vector<double>& of(Template feature_template) const {
        return tables_[static_cast<std::size_t>(feature_template)];
    }

private:
    std::vector<std::vector<std::size_t>> dimensions_;
    std::vector<std::vector<double>> tables_;
};

}  // namespace explicable
