// The weights of features as a scorer wants them: those that are always added together summed up beforehand.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

bool any(const std::vector<double>& weights) {
    return std::ranges::any_of(weights, [](double weight) { return weight != 0; });
}

}  // namespace

Scorer::Scorer(const Task& task, std::shared_ptr<const TeamTables> tables, const FeatureWeights& weights,
               std::vector<double> own, Transitions transitions, bool expected)
    : task_(task),
      tables_(std::move(tables)),
      after_(weights.of(Template::kAfter)),
      before_(weights.of(Template::kBefore)),
      same_human_(weights.of(Template::kSameHuman)),
      undoes_(weights.of(Template::kUndoes)),
      returns_(weights.of(Template::kReturns)),
      unbelieved_(weights.of(Template::kUnbelieved)),
      own_(std::move(own)),
      request_mission_(weights.of(Template::kRequestMission)),
      trend_(weights.of(Template::kTrend)),
      outlook_(weights.of(Template::kOutlook)),
      transitions_(transitions),
      factors_(),
      num_schemas_(static_cast<std::size_t>(tables_->num_schemas)),
      num_compared_(std::min(tables_->max_arity, kMaxArguments)),
      expected_(expected),
      uses_returns_(any(returns_)),
      uses_human_(any(same_human_)) {
    constexpr std::size_t n = kNumProgress;
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        for (std::size_t last = 0; last <= num_schemas_; ++last)
            after_[schema * (num_schemas_ + 1) + last] += weights.of(Template::kStep)[schema];
        for (std::size_t mental = 0; mental < n; ++mental) {
            for (std::size_t own = 0; own < n; ++own) {
                request_.push_back(weights.of(Template::kRequestMental)[schema * n + mental] +
                                   weights.of(Template::kRequestOwn)[schema * n + own] +
                                   weights.of(Template::kRequestModels)[mental * n + own]);
                for (std::size_t mission = 0; mission < n; ++mission)
                    goals_.push_back(weights.of(Template::kGoalMental)[schema * n + mental] +
                                     weights.of(Template::kGoalOwn)[schema * n + own] +
                                     weights.of(Template::kMission)[schema * n + mission]);
            }
        }
    }
    if (!own_.empty() && own_.size() != static_cast<std::size_t>(tables_->num_operators()))
        throw std::invalid_argument("one score an operator is needed, or none");
    if (!std::ranges::all_of(own_, [](double score) { return std::isfinite(score); }))
        throw std::invalid_argument("a score is not finite");
    share_arguments(weights.of(Template::kSameAfter), weights.of(Template::kSameBefore));
    double largest = -std::numeric_limits<double>::infinity();
    for (const auto& row : transitions)
        for (const auto transition : row) {
            if (!(std::abs(transition) <= 300)) throw std::invalid_argument("a transition weight is beyond 300");
            largest = std::max(largest, transition);
        }
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) factors_[i][j] = std::exp(transitions[i][j] - largest);
    find_bounds();
}

void Scorer::share_arguments(const std::vector<double>& after, const std::vector<double>& before) {
    const std::size_t n = num_schemas_, count = num_compared_;
    for (std::size_t step = 0; step < n; ++step) {
        for (std::size_t last = 0; last < n; ++last) {
            may_share_.push_back(0);
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t j = 0; j < count; ++j) {
                    const Equalities weight{after[((step * n + last) * count + i) * count + j],
                                            before[((last * n + step) * count + j) * count + i]};
                    if (weight.of_step != 0 || weight.of_last != 0) may_share_.back() = 1;
                    same_.push_back(weight);
                }
            }
        }
    }
}

}  // namespace explicable
