// The FF heuristic of a node, explicable or plain, with its preferred operators.
#pragma once

#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "search/engine.hpp"
#include "search/node_store.hpp"
#include "search/open_list.hpp"
#include "search/relaxed_plan.hpp"

namespace explicable {

enum class Preferred {
    none,
    helpful,      // applicable operators that add what the relaxed plan achieves first (Hoffmann & Nebel 2001)
    relaxed_plan  // applicable operators of the relaxed plan (Fast Downward)
};

struct LabelledOptions {
    const PathScorer* scorer = nullptr;
    Closing closing = Closing::state;
};

class Evaluator {
public:
    Evaluator(const Question& question, const PathScorer* scorer, SupporterCost supporter_cost = SupporterCost::unit)
        : planner_(question.prepared, question.goal, supporter_cost),
          counter_(scorer ? scorer->counter() : nullptr),
          child_counter_(counter_ ? counter_->of_children() : nullptr),
          real_costs_(supporter_cost != SupporterCost::unit) {}

    // |rp|, or with a scorer (1 + c) |rp| (Eq. 4 of the paper), c the number of inexplicable steps of path # rp.
    double evaluate(NodeStore& nodes, NodeId node, const State& state) {
        return evaluate(state, [&](auto relaxed_plan) { return counter_->count(nodes.context(node), state, relaxed_plan); });
    }
    // From now on evaluate_child() is asked about the children of this node.
    void start_children(NodeStore& nodes, NodeId parent, const State& state) {
        if (child_counter_) child_counter_->start(nodes.context(parent), state);
    }
    // The same as evaluate(), without a context.
    double evaluate_child(NodeStore& nodes, NodeId node, const State& state) {
        if (!child_counter_) return evaluate(nodes, node, state);
        return evaluate(state, [&](auto relaxed_plan) { return child_counter_->count(nodes.step(node), state, relaxed_plan); });
    }
    // Of the state evaluated last: the relaxed plan, one goal after another.
    std::span<const OperatorId> relaxed_plan() { return planner_.plan_by_goal(); }
    // Of the state evaluated last.
    void preferred(Preferred kind, const std::vector<OperatorId>& applicable, std::vector<OperatorId>& result) const {
        result.clear();
        if (kind == Preferred::helpful) planner_.helpful(applicable, result);
        if (kind == Preferred::relaxed_plan) planner_.in_plan(applicable, result);
    }
    // In labelled search best-first search orders by f = g + h, as the paper does; plain greedy search by h alone.
    Key key(double cost, double h) const { return counter_ ? Key{cost + h, h} : Key{h, 0.0}; }

private:
    RelaxedPlanner planner_;
    std::unique_ptr<Counter> counter_;  // of inexplicable steps; none in plain search
    ChildCounter* child_counter_;       // none if a child's context is needed
    bool real_costs_;

    template <class Count>
    double evaluate(const State& state, Count count) {
        if (!planner_.compute(state)) return dead_end;
        if (!counter_) return static_cast<double>(real_costs_ ? planner_.plan_cost() : std::ssize(planner_.plan()));
        const auto relaxed_plan = planner_.ordered_plan();
        return (1.0 + count(relaxed_plan)) * static_cast<double>(relaxed_plan.size());
    }
};

}  // namespace explicable
