#include "search/node_store.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>

#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr std::size_t alignment = alignof(std::max_align_t);
constexpr double rounding = 1e-12;  // leads that are no larger are none

std::size_t context_width(const PathScorer* scorer) {
    return scorer ? (std::max<std::size_t>(scorer->context_size(), 1) + alignment - 1) / alignment * alignment : alignment;
}

}  // namespace

NodeStore::NodeStore(const Task& task, const PathScorer* scorer, Closing closing, double price, bool limits_cost)
    : task_(task),
      scorer_(scorer),
      closing_(scorer ? closing : Closing::state),
      price_(price),
      charges_(scorer && scorer->charges()),
      limits_cost_(limits_cost),
      packer_(task),
      registry_(packer_.num_words() + by_context()),
      contexts_(context_width(scorer)),
      words_(packer_.num_words() + 1),
      context_(context_width(scorer)) {}

NodeId NodeStore::add_root(const State& state, const std::byte* context) {
    packer_.pack(state, words_.data());
    after_ = state;
    if (scorer_ && context) std::memcpy(context_.data(), context, scorer_->context_size());
    if (scorer_ && !context) scorer_->root(state, context_.data());
    if (by_context()) return insert_by_context(0, -1, -1).node;
    registry_.insert(words_.data());
    return append(0, -1, -1, true);
}

NodeStore::Arrival NodeStore::add(NodeId parent, OperatorId step) {
    if (nodes_.size() >= static_cast<std::size_t>(std::numeric_limits<NodeId>::max())) throw std::bad_alloc();
    apply(task_, packer_, step, words(parent), words_.data());
    const std::int64_t cost = nodes_.row(parent)->cost + task_.cost[step];
    if (by_context()) {
        extend(parent, step, words_.data());
        return insert_by_context(cost, parent, step);
    }
    const auto [node, is_new] = registry_.insert(words_.data());
    if (!is_new) return {node, false, cost < nodes_.row(node)->cost};
    if (charges_) extend(parent, step, words_.data());
    return {append(cost, parent, step, charges_), true, false};
}

// Sets context_ and after_ to what `step` from `parent` to the state `to` makes of them.
void NodeStore::extend(NodeId parent, OperatorId step, const Word* to) {
    const std::byte* const of_parent = context(parent);
    if (parent != parent_before_) unpack(words(parent), before_);
    parent_before_ = parent;
    unpack(to, after_);
    scorer_->extend(of_parent, step, before_, after_, context_.data());
}

bool NodeStore::dominates(const Rival& a, std::int64_t cost_a, const std::byte* context_a, const Rival& b,
                          std::int64_t cost_b, const std::byte* context_b) const {
    if (limits_cost_ && cost_a > cost_b) return false;
    const double saved = spent(cost_b, context_b) - spent(cost_a, context_a);
    if (closing_ == Closing::objective) {
        return price_ > 0 ? price_ * scorer_->lead(context_a, context_b, after_) <= saved + rounding : saved >= 0;
    }
    return saved >= 0 && (closing_ != Closing::context_and_length || a.num_steps >= b.num_steps) &&
           scorer_->lead(context_a, context_b, after_) <= rounding;
}

// Files what words_, context_ and after_ describe.
NodeStore::Arrival NodeStore::insert_by_context(std::int64_t cost, NodeId parent, OperatorId step) {
    words_[packer_.num_words()] = scorer_->closing_key(context_.data());
    const auto [state, is_new] = registry_.insert(words_.data());
    if (is_new) first_rival_.push_back(-1);
    const PathScore score = scorer_->score(context_.data(), after_, {});
    Rival rival{state, -1, score.num_inexplicable, score.num_steps, false};
    for (NodeId other = first_rival_[state]; other >= 0; other = rivals_[other].next) {
        if (dominates(rivals_[other], nodes_.row(other)->cost, contexts_.row(places_[other]), rival, cost, context_.data())) {
            return {other, false, false};
        }
    }
    NodeId* link = &first_rival_[state];
    while (*link >= 0) {
        Rival& other = rivals_[*link];
        if (dominates(rival, cost, context_.data(), other, nodes_.row(*link)->cost, contexts_.row(places_[*link]))) {
            other.dominated = true;
            *link = other.next;
        } else {
            link = &other.next;
        }
    }
    rival.next = first_rival_[state];
    const NodeId node = append(cost, parent, step, true);
    rivals_.push_back(rival);
    first_rival_[state] = node;
    return {node, true, false};
}

// Takes what is in context_ for its context, or none.
NodeId NodeStore::append(std::int64_t cost, NodeId parent, OperatorId step, bool has_context) {
    const auto node = static_cast<NodeId>(nodes_.size());
    *nodes_.append() = {cost, parent, step};
    if (!scorer_) return node;
    places_.push_back(-1);
    if (has_context) append_context(node);
    return node;
}

void NodeStore::append_context(NodeId node) {
    places_[node] = static_cast<std::int32_t>(contexts_.size());
    std::memcpy(contexts_.append(), context_.data(), context_.size());
}

const std::byte* NodeStore::context(NodeId node) {
    std::vector<NodeId> without;
    for (NodeId at = node; places_[at] < 0; at = nodes_.row(at)->parent) without.push_back(at);
    for (auto at = without.rbegin(); at != without.rend(); ++at) {
        extend(nodes_.row(*at)->parent, nodes_.row(*at)->step, words(*at));
        append_context(*at);
    }
    return contexts_.row(places_[node]);
}

void NodeStore::reparent(NodeId node, NodeId parent, OperatorId step) {
    *nodes_.row(node) = {nodes_.row(parent)->cost + task_.cost[step], parent, step};
    if (!scorer_ || places_[node] < 0) return;
    extend(parent, step, words(node));
    std::memcpy(contexts_.row(places_[node]), context_.data(), context_.size());
}

void NodeStore::unpack(const Word* words, State& state) const {
    const VariableId num_variables = task_.num_variables();
    state.values.resize(num_variables);
    for (VariableId variable = 0; variable < num_variables; ++variable) {
        state.values[variable] = packer_.get(words, variable);
    }
}

void NodeStore::state(NodeId node, State& state) const { unpack(words(node), state); }

std::vector<OperatorId> NodeStore::path(NodeId node) const {
    std::vector<OperatorId> steps;
    for (; nodes_.row(node)->parent >= 0; node = nodes_.row(node)->parent) steps.push_back(nodes_.row(node)->step);
    std::reverse(steps.begin(), steps.end());
    return steps;
}

std::size_t NodeStore::memory_bytes() const {
    return registry_.memory_bytes() + nodes_.memory_bytes() + contexts_.memory_bytes() + places_.capacity() * sizeof(places_[0]) +
           rivals_.capacity() * sizeof(Rival) + first_rival_.capacity() * sizeof(NodeId);
}

}  // namespace explicable
