// Anytime search: better plans one after another, until one is proved optimal or a limit is reached.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "search/engine.hpp"
#include "search/path_scorer.hpp"

namespace explicable {

struct SearchOptions;
struct SearchAnswer;

constexpr double rounding = 1e-9;  // no plan counts as better that is better by less

// The best plan so far, by J = cost + charge + alpha * dist (Eq. 3 of the paper). Without a scorer J is the cost.
struct Incumbent {
    const PathScorer* scorer = nullptr;
    double alpha = 0.0;
    bool ratio = false;  // dist is the share of inexplicable steps, not their number
    std::int64_t max_cost = no_max_cost;  // dearer plans are refused
    std::function<void(double)> on_better{};  // called with the objective of each better plan

    std::optional<std::vector<OperatorId>> plan{};
    std::int64_t cost = 0;
    double objective = std::numeric_limits<double>::infinity();

    bool limits_cost() const { return max_cost < no_max_cost; }
    // Executes the plan and keeps it if it is better; throws std::logic_error if the task refuses it.
    bool offer(std::vector<OperatorId> candidate, const Question& question);
    double penalty(const PathScore& score) const;
};

// With a scorer: sweeps over what may lie ahead of all states, or of those near the best plan, and A* with them.
void improve_objective(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
                       SearchAnswer& answer);

// Goes on from a first plan; sets lower_bound and is_optimal.
void improve(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
             SearchAnswer& answer);

}  // namespace explicable
