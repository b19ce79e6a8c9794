// Questions as they come from Python: what is no state, goal or plan of the task is refused.
#pragma once

#include <cstring>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/core_task.hpp"
#include "search/engine.hpp"
#include "search/plan_check.hpp"

namespace explicable {

// Copied, since bytes need not be aligned; refuses values that no variable of this task has.
inline State state_of(const CoreTask& task, const nb::bytes& bytes) {
    std::vector<Word> words(task.packer.num_words());
    if (bytes.size() != words.size() * sizeof(Word)) throw std::invalid_argument("not a state of this task");
    if (!words.empty()) std::memcpy(words.data(), bytes.c_str(), bytes.size());
    State state = task.packer.unpack(words.data());
    for (VariableId variable = 0; variable < task.num_variables(); ++variable) {
        if (state.values[variable] > std::ssize(task.variable_facts[variable])) {
            throw std::invalid_argument("not a state of this task");
        }
    }
    return state;
}

inline void check_goal(const Task& task, const std::vector<FactId>& goal) {
    for (const FactId fact : goal) {
        if (fact < 0 || fact >= task.num_facts()) throw nb::index_error("no such fact");
    }
}

inline void check_plan(const Question& question, const std::vector<OperatorId>& plan) {
    for (const OperatorId step : plan) {
        if (step < 0 || step >= question.task.num_operators()) throw std::invalid_argument("no such operator");
    }
    if (!execute_plan(question.task, question.initial, question.goal, plan)) throw std::invalid_argument("not a plan of this task");
}

}  // namespace explicable
