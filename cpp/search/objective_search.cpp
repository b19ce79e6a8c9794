#include "search/objective_search.hpp"

#include <algorithm>

namespace explicable {

Status ObjectiveSearch::run(Monitor& monitor, std::int64_t slice, double gap, Incumbent& best) {
    const std::int64_t end = end_of_slice(monitor, slice);
    if (nodes_.size() == 0) file(nodes_.add_root(question_.initial), monitor, best);
    while (!open_.empty()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        if (weight_ == 1.0 && lower_bound(best) >= (1.0 - gap) * best.objective) return Status::exhausted;
        const Open entry = open_.pop();
        if (nodes_.is_dominated(entry.node) || entry.bound >= best.objective - rounding) continue;
        ++monitor.expansions;
        nodes_.state(entry.node, state_);
        question_.successors.applicable(state_, applicable_);
        for (const OperatorId step : applicable_) {
            const auto arrival = nodes_.add(entry.node, step);
            if (arrival.is_new) file(arrival.node, monitor, best);
        }
    }
    return Status::exhausted;
}

void ObjectiveSearch::file(NodeId node, Monitor& monitor, Incumbent& best) {
    ++monitor.evaluations;
    const double ahead = outlook_(nodes_.words(node), nodes_.context(node));
    if (ahead == dead_end || !outlook_.affords(nodes_.cost(node), nodes_.words(node))) return;
    const double spent = nodes_.spent(node);
    const double penalty = best.penalty({nodes_.path_count(node), 0.0, nodes_.path_steps(node)});
    if (spent + penalty < best.objective) {
        nodes_.state(node, child_);
        if (question_.is_goal(child_)) best.offer(nodes_.path(node), question_);
    }
    const double so_far = spent + price_ * scorer_.least_count(nodes_.context(node));
    if (so_far + ahead >= best.objective - rounding) return;
    open_.push({so_far + weight_ * ahead, best.ratio ? penalty : ahead}, {node, so_far + ahead});
}

}  // namespace explicable
