// Look-ahead (Vidal 2004, YAHSP): a relaxed plan is carried out in earnest, as far as it will go.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search/engine.hpp"
#include "search/node_store.hpp"

namespace explicable {

class Lookahead {
public:
    explicit Lookahead(const Question& question)
        : question_(question),
          wanted_(question.task.num_facts(), 0),
          provided_(question.task.num_facts(), 0),
          provider_(question.task.num_facts()) {}

    // Executes operators of `relaxed_plan` in its order, again and again, while any is applicable. Where none is, an operator
    // that is applicable replaces the first one that was to achieve the same wanted fact. Each step becomes a node like any
    // other. Returns the last one; `state`, of which `node` is the node, becomes its state.
    NodeId follow(std::span<const OperatorId> relaxed_plan, NodeStore& nodes, NodeId node, State& state);

private:
    const Question& question_;
    std::vector<OperatorId> remaining_, applicable_;
    std::vector<std::uint32_t> wanted_, provided_;  // round of the mark
    std::vector<std::int32_t> provider_;            // of a fact: a place in remaining_
    std::uint32_t round_ = 0;

    bool is_applicable(OperatorId step, const State& state) const;
    OperatorId repair(const State& state);
    void mark_wanted(const State& state);
};

}  // namespace explicable
