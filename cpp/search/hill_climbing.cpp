#include "search/hill_climbing.hpp"

namespace explicable {

HillClimbing::HillClimbing(const Question& question, LabelledOptions labelled, std::uint64_t seed)
    : question_(question), labelled_(labelled), evaluator_(question, labelled.scorer), ties_(seed) {}

Status HillClimbing::run(Monitor& monitor, std::int64_t slice) {
    const std::int64_t end = end_of_slice(monitor, slice);
    if (!started_) {
        started_ = true;
        nodes_ = std::make_unique<NodeStore>(question_.task, labelled_.scorer, labelled_.closing);
        const NodeId root = nodes_->add_root(question_.initial);
        best_h_ = visit(root, monitor);
        if (best_h_ != dead_end) enqueue(root, monitor);
        done_ = question_.is_goal(state_);
        if (done_) return Status::solved;
    }
    while (!done_ && next_ < queue_.size()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        const Branch branch = queue_[next_++];
        if (nodes_->is_dominated(branch.node)) continue;
        const auto arrival = nodes_->add(branch.node, branch.step);
        if (!arrival.is_new) continue;
        const double h = visit(arrival.node, monitor);
        if (h == dead_end) continue;
        if (question_.is_goal(state_)) {
            const auto steps = nodes_->path(arrival.node);
            plan_.insert(plan_.end(), steps.begin(), steps.end());
            done_ = true;
            return Status::solved;
        }
        if (h < best_h_) {
            commit(arrival.node, h, monitor);
        } else {
            enqueue(arrival.node, monitor);
        }
    }
    return Status::exhausted;
}

double HillClimbing::visit(NodeId node, Monitor& monitor) {
    nodes_->state(node, state_);
    ++monitor.evaluations;
    return evaluator_.evaluate(*nodes_, node, state_);
}

// Queues the helpful actions of the node that was visited last.
void HillClimbing::enqueue(NodeId node, Monitor& monitor) {
    ++monitor.expansions;
    question_.successors.applicable(state_, applicable_);
    ties_.shuffle(applicable_);
    evaluator_.preferred(Preferred::helpful, applicable_, helpful_);
    for (const OperatorId step : helpful_) queue_.push_back({node, step});
}

// Makes the node that was visited last the start of a new breadth-first search.
void HillClimbing::commit(NodeId node, double h, Monitor& monitor) {
    const auto steps = nodes_->path(node);
    plan_.insert(plan_.end(), steps.begin(), steps.end());
    best_h_ = h;
    auto fresh = std::make_unique<NodeStore>(question_.task, labelled_.scorer, labelled_.closing);
    const NodeId root = fresh->add_root(state_, labelled_.scorer ? nodes_->context(node) : nullptr);
    nodes_ = std::move(fresh);
    queue_.clear();
    next_ = 0;
    enqueue(root, monitor);
}

std::size_t HillClimbing::memory_bytes() const {
    return (nodes_ ? nodes_->memory_bytes() : 0) + queue_.capacity() * sizeof(Branch);
}

}  // namespace explicable
