#include "search/lazy.hpp"

namespace explicable {

LazySearch::LazySearch(const Question& question, Preferred preferred, LabelledOptions labelled, std::uint64_t seed)
    : question_(question),
      preferred_(preferred),
      nodes_(question.task, labelled.scorer, labelled.closing),
      evaluator_(question, labelled.scorer),
      ties_(seed) {}

Status LazySearch::run(Monitor& monitor, std::int64_t slice) {
    if (goal_node_ >= 0) return Status::exhausted;
    const std::int64_t end = end_of_slice(monitor, slice);
    if (!started_) {
        started_ = true;
        if (visit(nodes_.add_root(question_.initial), monitor)) return Status::solved;
    }
    while (!all_.empty() || !promising_.empty()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        const Edge edge = next_edge();
        if (nodes_.is_dominated(edge.parent)) continue;
        const auto arrival = nodes_.add(edge.parent, edge.step);
        if (arrival.is_new && visit(arrival.node, monitor)) return Status::solved;
    }
    return Status::exhausted;
}

LazySearch::Edge LazySearch::next_edge() {
    const bool take_promising = !promising_.empty() && (all_.empty() || promising_priority_ <= all_priority_);
    ++(take_promising ? promising_priority_ : all_priority_);
    return (take_promising ? promising_ : all_).pop();
}

// Evaluates and expands a node; true if it is a goal.
bool LazySearch::visit(NodeId node, Monitor& monitor) {
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
    const Key key = evaluator_.key(static_cast<double>(nodes_.cost(node)), h);
    push(promising_, key, node, marked_);
    push(all_, key, node, applicable_);
    return false;
}

void LazySearch::push(OpenList<Edge>& open, const Key& key, NodeId node, const std::vector<OperatorId>& operators) {
    edges_.clear();
    for (const OperatorId step : operators) edges_.push_back({node, step});
    open.push_all(key, edges_);
}

}  // namespace explicable
