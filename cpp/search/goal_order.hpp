// Plans that achieve one goal after another, and better and better orders of the goals.
#pragma once

#include <optional>
#include <vector>

#include "search/engine.hpp"
#include "search/evaluator.hpp"
#include "search/improve.hpp"

namespace explicable {

class GoalOrder {
public:
    GoalOrder(const Question& question, LabelledOptions labelled, std::uint64_t seed)
        : question_(question), labelled_(labelled), seed_(seed), ties_(seed) {}

    // Moves one goal after another to another place in the order in which the plan of `best` achieves them, as long as that makes
    // J better; with `shuffled`, from an order drawn at random, whose plan takes the place of `best`. False if the monitor stopped.
    bool improve(Monitor& monitor, Incumbent& best, bool shuffled);

private:
    struct Part {
        FactId goal;
        std::vector<OperatorId> steps;  // that achieve it and keep all goals before it
        State after;
    };
    using Parts = std::vector<Part>;

    const Question& question_;
    LabelledOptions labelled_;
    std::uint64_t seed_;
    TieBreaker ties_;

    std::vector<FactId> order_of(const std::vector<OperatorId>& plan) const;
    std::optional<Parts> serialise(const std::vector<FactId>& order, const Parts& kept, std::size_t num_kept, Monitor& monitor) const;
    static std::vector<OperatorId> plan_of(const Parts& parts);
};

}  // namespace explicable
