// Look-ahead (Vidal 2004, YAHSP): a relaxed plan is carried out in earnest, as far as it will go.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search/engine.hpp"
#include "search/node_store.hpp"

namespace explicable {

enum class Ahead {
    no,
    plain,   // while an operator of the relaxed plan, or one in its place, is applicable
    bridged  // also by bringing back what has been deleted and is still needed; this may use up what can't be had again
};

class Lookahead {
public:
    Lookahead(const Question& question, Ahead ahead)
        : question_(question),
          bridged_(ahead == Ahead::bridged),
          wanted_(question.task.num_facts(), 0),
          provided_(question.task.num_facts(), 0),
          place_(question.task.num_facts()) {}

    // Executes operators of `relaxed_plan` in its order, again and again, while any is applicable. Where none is, an operator
    // that is applicable replaces the first one that was to achieve the same wanted facts, or else, if `bridged`, brings back a
    // fact that the way so far has deleted and the next step needs. Each step becomes a node like any other. Returns the last one; `state`,
    // of which `node` is the node, becomes its state.
    NodeId follow(std::span<const OperatorId> relaxed_plan, NodeStore& nodes, NodeId node, State& state, Monitor& monitor);

private:
    const Question& question_;
    bool bridged_;
    std::vector<OperatorId> remaining_, applicable_;
    std::vector<char> had_;                         // facts that were true somewhere on the way
    std::vector<std::uint32_t> wanted_, provided_;  // round of the mark
    std::vector<std::int32_t> place_;               // in remaining_, of the first operator that achieves or lacks a fact
    std::uint32_t round_ = 0;

    bool is_applicable(OperatorId step, const State& state) const;
    bool execute_remaining(NodeStore& nodes, NodeId& node, State& state);
    void go(OperatorId step, NodeStore& nodes, NodeId& node, State& state);
    OperatorId replace(const State& state);
    OperatorId bridge(const State& state);
    FactId only_missing(OperatorId step, const State& state) const;
    bool serves(OperatorId step, std::int32_t place) const;
    bool spoils(OperatorId step, OperatorId other) const;
    void mark_provided(const State& state);
    void begin_round();
};

}  // namespace explicable
