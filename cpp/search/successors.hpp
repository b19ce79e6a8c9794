// Which operators are applicable in a state: a decision tree over variables (as in Fast Downward), flat in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "task/state.hpp"

namespace explicable {

class SuccessorGenerator {
public:
    explicit SuccessorGenerator(const Task& task);

    // Replaces `operators` by all those applicable in `state`, in an order that is fixed for the task.
    void applicable(const State& state, std::vector<OperatorId>& operators) const;

private:
    // A node is [#operators, operators..., #branches, branches...]; a branch is [variable, first value, #values, table],
    // where code_[table + value - first] is the child's place, or 0 if there is none.
    std::vector<std::int32_t> code_;
    std::int32_t root_ = 0;

    struct Candidate;
    std::int32_t build(std::vector<Candidate>& candidates, std::size_t begin, std::size_t end, std::size_t depth);
    void collect(std::int32_t node, const State& state, std::vector<OperatorId>& operators) const;
};

}  // namespace explicable
