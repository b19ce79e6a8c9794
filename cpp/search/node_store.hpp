// The nodes of a search: packed states without duplicates, back-pointers and, in labelled search, scorer contexts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "search/path_scorer.hpp"
#include "search/rows.hpp"
#include "task/packed_state.hpp"
#include "task/state_registry.hpp"

namespace explicable {

using NodeId = std::int32_t;

// When are two nodes the same? With `state`, there is one node a state. With `context`, nodes must also agree in the scorer's
// closing key; among such, a node is dominated by one that costs no more and, whatever follows, has no more inexplicable steps.
// With `context_and_length` it must have no fewer steps either: a longer path dilutes the share of inexplicable steps. With
// `objective` a node is dominated by one whose cost + price * inexplicable steps is no higher, whatever follows; if costs are limited,
// its cost may be no higher either.
enum class Closing { state, context, context_and_length, objective };

class NodeStore {
public:
    NodeStore(const Task& task, const PathScorer* scorer, Closing closing, double price = 0.0, bool limits_cost = false);

    NodeId add_root(const State& state, const std::byte* context = nullptr);

    struct Arrival {
        NodeId node;
        bool is_new;
        bool is_cheaper;  // not new, but reached at lower cost than ever; see reparent()
    };
    Arrival add(NodeId parent, OperatorId step);
    void reparent(NodeId node, NodeId parent, OperatorId step);

    void state(NodeId node, State& state) const;
    const Word* words(NodeId node) const { return registry_[by_context() ? rivals_[node].state : node]; }  // packed state
    std::int64_t cost(NodeId node) const { return nodes_.row(node)->cost; }
    // Cost and charge.
    double spent(NodeId node) const { return spent(nodes_.row(node)->cost, charges_ ? contexts_.row(places_[node]) : nullptr); }
    // It stays where it is. If there is one node a state and paths are not charged, it is made when it is first asked for.
    const std::byte* context(NodeId node);
    OperatorId step(NodeId node) const { return nodes_.row(node)->step; }  // that led there; -1 for the root
    bool is_dominated(NodeId node) const { return by_context() && rivals_[node].dominated; }
    std::vector<OperatorId> path(NodeId node) const;
    std::int32_t size() const { return static_cast<std::int32_t>(nodes_.size()); }
    std::size_t memory_bytes() const;

    // Inexplicable steps of the path to `node`, and all; kept with context closing only.
    double path_count(NodeId node) const { return rivals_[node].count; }
    int path_steps(NodeId node) const { return rivals_[node].num_steps; }

private:
    struct Node {
        std::int64_t cost;
        NodeId parent;
        OperatorId step;
    };
    // Context closing only: nodes that agree in state and closing key are rivals, and form a list.
    struct Rival {
        StateId state;
        NodeId next;
        double count;
        std::int32_t num_steps;
        bool dominated;
    };

    const Task& task_;
    const PathScorer* scorer_;
    Closing closing_;
    double price_;
    bool charges_, limits_cost_;
    StatePacker packer_;
    StateRegistry registry_;  // of states, or of states with closing keys
    Rows<Node> nodes_;
    Rows<std::byte> contexts_;
    std::vector<std::int32_t> places_;  // of nodes in contexts_, or -1
    std::vector<Rival> rivals_;
    std::vector<NodeId> first_rival_;  // by number in the registry
    std::vector<Word> words_;
    std::vector<std::byte> context_;
    State before_, after_;
    NodeId parent_before_ = -1;  // whose state before_ is

    bool by_context() const { return closing_ != Closing::state; }
    double spent(std::int64_t cost, const std::byte* context) const {
        return static_cast<double>(cost) + (charges_ ? scorer_->charge(context) : 0.0);
    }
    bool dominates(const Rival& a, std::int64_t cost_a, const std::byte* context_a, const Rival& b, std::int64_t cost_b,
                   const std::byte* context_b) const;
    void unpack(const Word* words, State& state) const;
    NodeId append(std::int64_t cost, NodeId parent, OperatorId step, bool has_context);
    void append_context(NodeId node);
    void extend(NodeId parent, OperatorId step, const Word* to);
    Arrival insert_by_context(std::int64_t cost, NodeId parent, OperatorId step);
};

}  // namespace explicable
