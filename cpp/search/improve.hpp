// Anytime search: better plans one after another, until one is proved optimal or a limit is reached.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "search/engine.hpp"
#include "search/path_scorer.hpp"

namespace explicable {

struct SearchOptions;
struct SearchAnswer;

// The best plan so far, by J = cost + alpha * dist (Eq. 3 of the paper). Without a scorer J is the cost.
struct Incumbent {
    const PathScorer* scorer = nullptr;
    double alpha = 0.0;
    bool ratio = false;  // dist is the share of inexplicable steps, not their number

    std::optional<std::vector<OperatorId>> plan{};
    std::int64_t cost = 0;
    double objective = std::numeric_limits<double>::infinity();

    // Executes the plan and keeps it if it is better; throws std::logic_error if the task refuses it.
    bool offer(std::vector<OperatorId> candidate, const Question& question);
    double penalty(const PathScore& score) const;
};

// Goes on from a first plan; sets lower_bound and is_optimal.
void improve(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
             SearchAnswer& answer);

}  // namespace explicable
