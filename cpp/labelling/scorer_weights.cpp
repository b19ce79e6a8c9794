// The weights of features as a scorer wants them: those that are always added together summed up beforehand.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

constexpr double kMostPairScore = 200;  // up to which pairs are odds

bool any(const std::vector<double>& weights) {
    return std::ranges::any_of(weights, [](double weight) { return weight != 0; });
}

// Weight of argument i of `step` being argument j of `other`.
double of_arguments(const TeamTables& tables, const std::vector<double>& weights, std::size_t step, std::size_t other,
                    std::size_t i, std::size_t j) {
    const std::size_t count = std::min(tables.max_arity, kMaxArguments);
    return weights[((step * static_cast<std::size_t>(tables.num_schemas) + other) * count + i) * count + j];
}

}  // namespace

Scorer::Scorer(const Task& task, std::shared_ptr<const TeamTables> tables, const FeatureWeights& weights,
               std::vector<double> own, Transitions transitions, bool expected)
    : task_(task),
      tables_(std::move(tables)),
      own_(std::move(own)),
      undoes_(weights.of(Template::kUndoes)),
      returns_(weights.of(Template::kReturns)),
      same_(*tables_,
            [&](std::size_t step, std::size_t last, std::size_t i, std::size_t j) {
                return Pair{of_arguments(*tables_, weights.of(Template::kSameAfter), step, last, i, j),
                            of_arguments(*tables_, weights.of(Template::kSameBefore), last, step, j, i)};
            }),
      same_human_(*tables_,
                  [&](std::size_t step, std::size_t human, std::size_t i, std::size_t j) {
                      return of_arguments(*tables_, weights.of(Template::kSameHuman), step, human, i, j);
                  }),
      odds_of_same_(same_),
      memories_(std::make_shared<StepMemories>(static_cast<std::size_t>(tables_->num_operators()))),
      transitions_(transitions),
      factors_(),
      num_schemas_(static_cast<std::size_t>(tables_->num_schemas)),
      expected_(expected),
      uses_returns_(any(returns_)),
      uses_human_(same_human_.any()) {
    if (!own_.empty() && own_.size() != static_cast<std::size_t>(tables_->num_operators()))
        throw std::invalid_argument("one score an operator is needed, or none");
    if (!std::ranges::all_of(own_, [](double score) { return std::isfinite(score); }))
        throw std::invalid_argument("a score is not finite");
    sum_up(weights);
    find_odds();
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

void Scorer::find_odds() {
    const auto size = [](const Pair& pair) { return std::max(std::abs(pair.of_step), std::abs(pair.of_last)); };
    const auto most = [size](const std::vector<Pair>& pairs) { return size(std::ranges::max(pairs, {}, size)); };
    if (!expected_ || !(most(schemas_) + same_.most(size) + most(beside_) <= kMostPairScore)) return;
    has_odds_ = true;
    const auto odds = [](const Pair& pair) { return Pair{std::exp(pair.of_step), std::exp(pair.of_last)}; };
    std::ranges::transform(schemas_, std::back_inserter(odds_of_schemas_), odds);
    std::ranges::transform(beside_, std::back_inserter(odds_beside_), odds);
    odds_of_same_ = same_.map(odds);
}

void Scorer::sum_up(const FeatureWeights& weights) {
    constexpr std::size_t n = kNumProgress, k = kCodes;
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        const double step = weights.of(Template::kStep)[schema];
        alone_.insert(alone_.end(), {step + weights.of(Template::kUnbelieved)[schema], step});
    }
    request_.resize(num_schemas_ * k * k);
    goals_.resize(num_schemas_ * k * k * k);
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        for (std::size_t mental = 0; mental < n; ++mental) {
            for (std::size_t own = 0; own < n; ++own) {
                request_[(schema * k + mental) * k + own] = weights.of(Template::kRequestMental)[schema * n + mental] +
                                                            weights.of(Template::kRequestOwn)[schema * n + own] +
                                                            weights.of(Template::kRequestModels)[mental * n + own];
                for (std::size_t mission = 0; mission < n; ++mission)
                    goals_[((schema * k + mission) * k + own) * k + mental] =
                        weights.of(Template::kGoalMental)[schema * n + mental] +
                        weights.of(Template::kGoalOwn)[schema * n + own] + weights.of(Template::kMission)[schema * n + mission];
            }
        }
    }
    request_mission_.resize(k * k);
    for (std::size_t request = 0; request < n; ++request)
        for (std::size_t mission = 0; mission < n; ++mission)
            request_mission_[request * k + mission] = weights.of(Template::kRequestMission)[request * n + mission];
    const std::size_t width = num_schemas_ + 1;
    schemas_.resize(width * width);
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        for (std::size_t other = 0; other < width; ++other) {
            schemas_[schema * width + other].of_step = weights.of(Template::kAfter)[schema * width + other];
            schemas_[other * width + schema].of_last = weights.of(Template::kBefore)[schema * width + other];
        }
    }
    beside_.resize(kNumNeighbours * kNumNeighbours);
    for (std::size_t mine = 0; mine < n; ++mine) {
        for (std::size_t other = 0; other < kNumNeighbours; ++other) {
            beside_[mine * kNumNeighbours + other].of_step = weights.of(Template::kTrend)[mine * kNumNeighbours + other];
            beside_[other * kNumNeighbours + mine].of_last = weights.of(Template::kOutlook)[mine * kNumNeighbours + other];
        }
    }
}

}  // namespace explicable
