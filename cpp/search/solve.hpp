// One door to all searches.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "search/engine.hpp"
#include "search/evaluator.hpp"

namespace explicable {

struct SearchOptions {
    std::string algorithm = "default";
    std::string heuristic;  // of "astar": lmcut (default), hmax, blind
    Preferred preferred = Preferred::helpful;
    bool lookahead = false;  // of "lazy"
    double weight = 1.0;  // of h, in "wastar"
    std::uint64_t seed = 0;
    LabelledOptions labelled;
    double alpha = 0.0;  // "anytime" with a scorer minimises cost + alpha * dist
    bool ratio = false;  // dist is the share of inexplicable steps, not their number
    std::int64_t max_cost = no_max_cost;  // of plans that "anytime" with a scorer may choose
    std::vector<std::vector<OperatorId>> known_plans;  // to begin with, in the place of a first search
    std::function<void(double)> on_better;  // called with the objective of each better plan of "anytime"
    double gap = 0.0;    // "anytime" with a scorer ends once no plan can be better by more than this share
};

enum class Outcome { solved, unsolvable, limit, interrupted };

struct SearchAnswer {
    Outcome outcome = Outcome::limit;
    Stop stop = Stop::none;
    std::optional<std::vector<OperatorId>> plan;
    std::int64_t cost = 0;
    double objective = 0.0;     // cost, or with a scorer cost + alpha * dist
    double lower_bound = 0.0;   // of the objective over all plans
    bool is_optimal = false;    // proved
    bool is_exhausted = false;  // the search space
    std::int64_t evaluations = 0, expansions = 0;
    std::size_t memory_bytes = 0;  // of the engine that found the first plan
    double search_s = 0.0;
};

// Throws std::invalid_argument where an option is unknown, std::logic_error if a plan fails its check.
SearchAnswer solve(const Question& question, const SearchOptions& options, Monitor& monitor);

}  // namespace explicable
