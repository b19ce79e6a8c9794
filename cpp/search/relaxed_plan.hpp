// Relaxed plans: the FF heuristic (Hoffmann & Nebel 2001) with best supporters by h_add (Bonet & Geffner 2001).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search/cost_queue.hpp"
#include "search/prepared_task.hpp"
#include "task/state.hpp"

namespace explicable {

class RelaxedPlanner {
public:
    RelaxedPlanner(const PreparedTask& prepared, std::span<const FactId> goal, SupporterCost supporter_cost);

    // False: the goal is out of reach even if nothing were ever deleted, so the state is a dead end.
    bool compute(const State& state);

    // All of the following speak about the last state for which compute() was true.
    // The relaxed plan as operators, in no particular order; each once, unless its conditional effects serve several layers.
    std::span<const OperatorId> plan() const { return plan_; }
    // The same in an order in which it can be executed in the delete relaxation: by the cost of reaching each operator.
    std::span<const OperatorId> ordered_plan();
    // The same in another such order: for one goal after another, the nearest first, all that it needs and is not there yet.
    std::span<const OperatorId> plan_by_goal();
    std::int64_t plan_cost() const;  // by the task's own costs
    std::int32_t h_add() const { return h_add_; }
    // Operators of `applicable` that add a fact which the relaxed plan achieves in its first layer (helpful actions).
    void helpful(std::span<const OperatorId> applicable, std::vector<OperatorId>& result) const;
    // Those of `applicable` that stand in the relaxed plan themselves: a subset of the helpful ones.
    void in_plan(std::span<const OperatorId> applicable, std::vector<OperatorId>& result) const;

private:
    struct Counter {
        std::int32_t unsatisfied;  // preconditions
        std::int32_t cost;         // own cost and that of the preconditions reached
    };
    struct Visit {
        FactId fact;
        std::int32_t next;  // the supporter's precondition to look at next
    };

    const Task& task_;
    const RelaxedTask& relaxed_;
    std::vector<FactId> goal_, goal_by_cost_;
    std::vector<char> is_goal_;
    std::int32_t num_goals_ = 0;
    std::vector<Counter> initial_counters_, counters_;
    std::vector<std::int32_t> fact_cost_, supporter_;  // a supporter is a place in relaxed_.adds
    CostQueue queue_;

    std::vector<OperatorId> plan_;
    std::vector<std::int32_t> costs_;     // of reaching each step, in depth-first order as all of these
    std::vector<std::int32_t> supports_;  // places in relaxed_.adds that the plan uses, if operators have several pieces
    std::vector<std::uint32_t> fact_seen_, fact_first_, operator_seen_;  // round of the mark
    std::uint32_t round_ = 0;
    std::vector<Visit> stack_;
    std::vector<std::int32_t> by_cost_, places_;
    std::vector<OperatorId> sorted_;
    std::int32_t h_add_ = 0;
    bool several_pieces_;

    void reach(FactId fact, std::int32_t cost, std::int32_t support) {
        if (cost < fact_cost_[fact]) {
            fact_cost_[fact] = cost;
            supporter_[fact] = support;
            queue_.push(cost, fact);
        }
    }
    void reach_adds(std::int32_t piece, std::int32_t cost) {
        const auto& adds = relaxed_.adds;
        for (std::int32_t i = adds.offsets[piece]; i < adds.offsets[piece + 1]; ++i) reach(adds.values[i], cost, i);
    }
    std::int32_t cost_of(std::int32_t support) const { return counters_[relaxed_.piece_of[support]].cost; }
    bool explore(const State& state);
    void extract(std::span<const FactId> goal);
    void extract_for(FactId goal);
    void sort_by_cost(const std::vector<std::int32_t>& values, std::vector<std::int32_t>& sorted);
};

}  // namespace explicable
