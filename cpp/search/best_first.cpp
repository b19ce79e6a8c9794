#include "search/best_first.hpp"

#include <algorithm>

namespace explicable {

BestFirstSearch::BestFirstSearch(const Question& question, BestFirstOptions options)
    : question_(question),
      options_(std::move(options)),
      nodes_(question.task, options_.labelled.scorer, options_.labelled.closing),
      ties_(options_.seed),
      is_marked_(options_.preferred == Preferred::none ? 0 : question.task.num_operators(), 0) {
    if (!options_.admissible) evaluator_.emplace(question, options_.labelled.scorer, options_.supporter_cost);
}

Status BestFirstSearch::run(Monitor& monitor, std::int64_t slice) {
    const std::int64_t end = end_of_slice(monitor, slice);
    if (options_.admissible) options_.admissible->monitor = &monitor;
    if (!started_) {
        started_ = true;
        const NodeId root = nodes_.add_root(question_.initial);
        if (evaluator_) evaluator_->start_children(nodes_, root, question_.initial);
        evaluate(root, monitor);
        push(root, false);
    }
    while (!all_.empty() || !promising_.empty()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        const NodeId node = next_node();
        if (expanded_[node] || nodes_.is_dominated(node)) continue;
        if (least_cost(node) >= options_.bound) continue;
        expanded_[node] = true;
        nodes_.state(node, state_);
        if (question_.is_goal(state_)) {
            goal_node_ = node;
            return Status::solved;
        }
        expand(node, monitor);
    }
    return Status::exhausted;
}

NodeId BestFirstSearch::next_node() {
    const bool take_promising = !promising_.empty() && (all_.empty() || promising_priority_ <= all_priority_);
    ++(take_promising ? promising_priority_ : all_priority_);
    return (take_promising ? promising_ : all_).pop();
}

void BestFirstSearch::evaluate(NodeId node, Monitor& monitor) {
    ++monitor.evaluations;
    nodes_.state(node, state_);
    const double h = options_.admissible ? options_.admissible->evaluate(state_)
                                         : evaluator_->evaluate_child(nodes_, node, state_);
    h_.push_back(h);
    expanded_.push_back(false);
}

Key BestFirstSearch::key(NodeId node) const {
    const double h = h_[node];
    if (options_.labelled.scorer) return evaluator_->key(nodes_.spent(node), h);
    const auto cost = static_cast<double>(nodes_.cost(node));
    return {options_.weight_g * cost + options_.weight_h * h, options_.weight_g == 0.0 ? 0.0 : h};
}

// What a plan through this node costs at the least.
double BestFirstSearch::least_cost(NodeId node) const {
    return static_cast<double>(nodes_.cost(node)) + (options_.admissible ? h_[node] : 0.0);
}

void BestFirstSearch::push(NodeId node, bool promising) {
    const double h = h_[node];
    if (h == dead_end || least_cost(node) >= options_.bound) return;
    if (h < best_h_) {
        best_h_ = h;
        promising_priority_ -= preferred_boost;
    }
    all_.push(key(node), node);
    if (promising) promising_.push(key(node), node);
}

void BestFirstSearch::expand(NodeId node, Monitor& monitor) {
    ++monitor.expansions;
    question_.successors.applicable(state_, applicable_);
    ties_.shuffle(applicable_);
    if (options_.preferred != Preferred::none) {
        // Other states have been evaluated since this one was, so its relaxed plan is computed anew.
        evaluator_->evaluate(nodes_, node, state_);
        evaluator_->preferred(options_.preferred, applicable_, marked_);
        for (const OperatorId step : marked_) is_marked_[step] = 1;
    }
    if (evaluator_) evaluator_->start_children(nodes_, node, state_);
    for (const OperatorId step : applicable_) {
        const auto arrival = nodes_.add(node, step);
        const bool promising = !is_marked_.empty() && is_marked_[step];
        if (arrival.is_new) {
            evaluate(arrival.node, monitor);
            push(arrival.node, promising);
        } else if (arrival.is_cheaper && options_.reopen) {
            nodes_.reparent(arrival.node, node, step);
            expanded_[arrival.node] = false;
            push(arrival.node, promising);
        }
    }
    if (!is_marked_.empty()) {
        for (const OperatorId step : marked_) is_marked_[step] = 0;
    }
}

}  // namespace explicable
