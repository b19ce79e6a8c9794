#include "search/lazy.hpp"

#include <utility>

namespace explicable {

LazySearch::LazySearch(const Question& question, Preferred preferred, LabelledOptions labelled, std::uint64_t seed,
                       Ahead ahead)
    : question_(question),
      preferred_(preferred),
      nodes_(question.task, labelled.scorer, labelled.closing),
      evaluator_(question, labelled.scorer),
      ties_(seed) {
    if (ahead != Ahead::no) lookahead_.emplace(question, ahead);
}

Status LazySearch::run(Monitor& monitor, std::int64_t slice) {
    if (goal_node_ >= 0) return Status::exhausted;
    const std::int64_t end = end_of_slice(monitor, slice);
    if (!started_) {
        started_ = true;
        next_ = nodes_.add_root(question_.initial);
    }
    while (next_ >= 0 || !all_.empty() || !promising_.empty()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        const NodeId node = next_ >= 0 ? std::exchange(next_, -1) : follow_edge();
        if (is_visited(node)) continue;
        if (visit(node, monitor)) return Status::solved;
    }
    return Status::exhausted;
}

// The node at the end of the next edge, or the parent where it is dominated.
NodeId LazySearch::follow_edge() {
    const bool take_promising = !promising_.empty() && (all_.empty() || promising_priority_ <= all_priority_);
    ++(take_promising ? promising_priority_ : all_priority_);
    const Edge edge = (take_promising ? promising_ : all_).pop();
    return nodes_.is_dominated(edge.parent) ? edge.parent : nodes_.add(edge.parent, edge.step).node;
}

// Evaluates and expands a node; true if it is a goal.
bool LazySearch::visit(NodeId node, Monitor& monitor) {
    visited_.resize(nodes_.size());
    visited_[node] = true;
    nodes_.state(node, state_);
    if (question_.is_goal(state_)) {
        goal_node_ = node;
        return true;
    }
    ++monitor.evaluations;
    const double h = evaluator_.evaluate(nodes_, node, state_);
    if (h == dead_end) return false;
    if (h < best_h_) {
        best_h_ = h;
        promising_priority_ -= preferred_boost;
    }
    ++monitor.expansions;
    question_.successors.applicable(state_, applicable_);
    ties_.shuffle(applicable_);
    evaluator_.preferred(preferred_, applicable_, marked_);
    const Key key = evaluator_.key(nodes_.spent(node), h);
    push(promising_, key, node, marked_);
    push(all_, key, node, applicable_);
    if (lookahead_) next_ = lookahead_->follow(evaluator_.relaxed_plan(), nodes_, node, state_, monitor);
    return false;
}

void LazySearch::push(OpenList<Edge>& open, const Key& key, NodeId node, const std::vector<OperatorId>& operators) {
    edges_.clear();
    for (const OperatorId step : operators) edges_.push_back({node, step});
    open.push_all(key, edges_);
}

}  // namespace explicable
