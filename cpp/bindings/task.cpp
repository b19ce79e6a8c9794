// explicable._core.Task and the function that grounds a lifted task.
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/core_task.hpp"
#include "grounding/ground.hpp"
#include "task/successor.hpp"

namespace explicable {
namespace {

using Numbers = nb::ndarray<const std::int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu, nb::ro>;
using Ints = std::vector<std::int32_t>;
using Effects = std::vector<std::tuple<Ints, Ints, Ints>>;

std::span<const std::int32_t> view(const Numbers& numbers) { return {numbers.data(), numbers.size()}; }

std::vector<std::span<const std::int32_t>> views(const std::vector<Numbers>& arrays) {
    std::vector<std::span<const std::int32_t>> result;
    for (const Numbers& array : arrays) result.push_back(view(array));
    return result;
}

void check(bool fine, const char* message) {
    if (!fine) throw std::invalid_argument(message);
}

FactId check_fact(const Task& task, FactId fact) {
    if (fact < 0 || fact >= task.num_facts()) throw nb::index_error("no such fact");
    return fact;
}
OperatorId check_operator(const Task& task, OperatorId op) {
    if (op < 0 || op >= task.num_operators()) throw nb::index_error("no such operator");
    return op;
}

// Signals are handled by Python code, and only where the interpreter lock is held.
void check_signals() {
    nb::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

std::unique_ptr<CoreTask> ground(const Numbers& structure, const std::vector<Numbers>& initial, const Ints& num_initial,
                                 const std::vector<Numbers>& function_arguments,
                                 const std::vector<Numbers>& function_values, std::size_t memory_limit_bytes) {
    const auto initial_views = views(initial);
    const auto argument_views = views(function_arguments), value_views = views(function_values);
    nb::gil_scoped_release release;
    grounding::LiftedTask lifted =
        grounding::read_lifted_task(view(structure), initial_views, num_initial, argument_views, value_views);
    return std::make_unique<CoreTask>(grounding::ground(lifted, memory_limit_bytes, check_signals));
}

// A row of facts as it must stand in a task: sorted, each fact once, all in range.
Ints checked_row(const Ints& facts, std::int32_t num_facts) {
    Ints row = facts;
    std::sort(row.begin(), row.end());
    check(std::adjacent_find(row.begin(), row.end()) == row.end(), "a fact stands twice in a row");
    check(row.empty() || (row.front() >= 0 && row.back() < num_facts), "fact out of range");
    return row;
}

void check_one_per_variable(const Task& task, const Ints& facts) {
    Ints variables;
    for (const FactId fact : facts) variables.push_back(task.fact_variable[fact]);
    std::sort(variables.begin(), variables.end());
    check(std::adjacent_find(variables.begin(), variables.end()) == variables.end(),
          "two facts of one variable are made true together");
}

// A propositional task: fact f is the atom (f), operator o the action (o).
std::unique_ptr<CoreTask> from_arrays(const std::vector<Ints>& variable_facts, const std::vector<Ints>& preconditions,
                                      const std::vector<Ints>& adds, const std::vector<Ints>& deletes,
                                      const Ints& costs, const std::vector<Effects>& effects, const Ints& initial,
                                      const Ints& goal, bool goal_reachable) {
    Task task;
    std::size_t num_facts = 0;
    for (const Ints& facts : variable_facts) num_facts += facts.size();
    check(num_facts < (std::size_t{1} << 30), "too many facts");
    const auto bound = static_cast<std::int32_t>(num_facts);
    task.fact_variable.assign(num_facts, -1);
    task.fact_value.assign(num_facts, 0);
    for (const Ints& facts : variable_facts) {
        check(!facts.empty(), "a variable without facts");
        std::int32_t value = 0;
        for (const FactId fact : facts) {
            check(fact >= 0 && fact < bound && task.fact_variable[fact] < 0, "each fact belongs to one variable");
            task.fact_variable[fact] = task.variable_facts.size();
            task.fact_value[fact] = ++value;
        }
        task.variable_facts.push_back(facts);
    }
    for (FactId fact = 0; fact < bound; ++fact) {
        task.fact_predicate.push_back(fact);
        task.fact_arguments.push_back(Ints{});
    }
    const std::size_t num_operators = preconditions.size();
    check(adds.size() == num_operators && deletes.size() == num_operators && costs.size() == num_operators &&
              (effects.empty() || effects.size() == num_operators),
          "one row an operator");
    for (std::size_t op = 0; op < num_operators; ++op) {
        check(costs[op] >= 0, "negative cost");
        const Ints add = checked_row(adds[op], bound);
        Ints remove = checked_row(deletes[op], bound);
        std::erase_if(remove, [&](FactId f) { return std::binary_search(add.begin(), add.end(), f); });
        check_one_per_variable(task, add);
        task.preconditions.push_back(checked_row(preconditions[op], bound));
        task.adds.push_back(add);
        task.deletes.push_back(remove);
        task.cost.push_back(costs[op]);
        task.operator_schema.push_back(static_cast<std::int32_t>(op));
        task.operator_arguments.push_back(Ints{});
        if (!effects.empty())
            for (const auto& [condition, effect_adds, effect_deletes] : effects[op]) {
                const Ints effect_add = checked_row(effect_adds, bound);
                check_one_per_variable(task, effect_add);
                task.effect_conditions.push_back(checked_row(condition, bound));
                task.effect_adds.push_back(effect_add);
                task.effect_deletes.push_back(checked_row(effect_deletes, bound));
            }
        task.effect_offsets.push_back(task.effect_conditions.size());
    }
    task.initial = checked_row(initial, bound);
    check_one_per_variable(task, task.initial);
    task.goal = checked_row(goal, bound);
    task.goal_reachable = goal_reachable;
    return std::make_unique<CoreTask>(std::move(task));
}

// A packed state as the bytes that Python holds.
nb::bytes to_bytes(const std::vector<Word>& words) { return nb::bytes(words.data(), words.size() * sizeof(Word)); }

// Copied, since bytes need not be aligned; refuses values that no variable of this task has.
std::vector<Word> to_words(const CoreTask& task, const nb::bytes& state) {
    check(state.size() == task.packer.num_words() * sizeof(Word), "not a state of this task");
    std::vector<Word> words(task.packer.num_words());
    if (!words.empty()) std::memcpy(words.data(), state.c_str(), state.size());
    for (VariableId v = 0; v < task.num_variables(); ++v)
        check(task.packer.get(words.data(), v) <= std::ssize(task.variable_facts[v]), "not a state of this task");
    return words;
}

nb::bytes pack(const CoreTask& task, const Ints& facts) {
    std::vector<Word> words(task.packer.num_words());
    for (const FactId fact : facts) {
        check_fact(task, fact);
        check(task.packer.get(words.data(), task.fact_variable[fact]) == 0 || task.packer.holds(words.data(), fact),
              "two facts that exclude each other");
        task.packer.add(words.data(), fact);
    }
    return to_bytes(words);
}

Ints true_facts(const CoreTask& task, const nb::bytes& state) {
    const auto words = to_words(task, state);
    Ints facts;
    for (VariableId v = 0; v < task.num_variables(); ++v)
        if (const std::int32_t value = task.packer.get(words.data(), v))
            facts.push_back(task.variable_facts[v][value - 1]);
    std::sort(facts.begin(), facts.end());
    return facts;
}

bool holds(const CoreTask& task, const nb::bytes& state, const Ints& facts) {
    const auto words = to_words(task, state);
    return std::all_of(facts.begin(), facts.end(),
                       [&](FactId fact) { return task.packer.holds(words.data(), check_fact(task, fact)); });
}

nb::bytes follow(const CoreTask& task, const nb::bytes& state, const std::vector<OperatorId>& operators) {
    auto from = to_words(task, state);
    std::vector<Word> to(from.size());
    for (const OperatorId op : operators) {
        apply(task, task.packer, check_operator(task, op), from.data(), to.data());
        std::swap(from, to);
    }
    return to_bytes(from);
}

nb::bytes successor(const CoreTask& task, const nb::bytes& state, OperatorId op) {
    const auto from = to_words(task, state);
    std::vector<Word> to(from.size());
    apply(task, task.packer, check_operator(task, op), from.data(), to.data());
    return to_bytes(to);
}

Effects effects_of(const CoreTask& task, OperatorId op) {
    Effects effects;
    auto copy = [](std::span<const FactId> facts) { return Ints(facts.begin(), facts.end()); };
    for (std::int32_t e = task.effect_offsets[check_operator(task, op)]; e < task.effect_offsets[op + 1]; ++e)
        effects.emplace_back(copy(task.effect_conditions[e]), copy(task.effect_adds[e]), copy(task.effect_deletes[e]));
    return effects;
}

// The task's arrays by name, for those who compute with them.
const Ints& array_named(const Task& task, const std::string& name) {
    const std::pair<const char*, const Ints*> arrays[] = {
        {"fact_predicate", &task.fact_predicate},
        {"fact_variable", &task.fact_variable},
        {"fact_value", &task.fact_value},
        {"fact_arguments.offsets", &task.fact_arguments.offsets},
        {"fact_arguments.values", &task.fact_arguments.values},
        {"cost", &task.cost},
        {"operator_schema", &task.operator_schema},
        {"operator_arguments.offsets", &task.operator_arguments.offsets},
        {"operator_arguments.values", &task.operator_arguments.values},
        {"preconditions.offsets", &task.preconditions.offsets},
        {"preconditions.values", &task.preconditions.values},
        {"adds.offsets", &task.adds.offsets},
        {"adds.values", &task.adds.values},
        {"deletes.offsets", &task.deletes.offsets},
        {"deletes.values", &task.deletes.values},
    };
    for (const auto& [known, values] : arrays)
        if (name == known) return *values;
    throw std::invalid_argument("no such array: " + name);
}

}  // namespace
}  // namespace explicable

void bind_task(nb::module_& module) {
    using namespace explicable;
    using namespace nb::literals;

    nb::class_<Task>(module, "TaskData");
    auto task = nb::class_<CoreTask, Task>(module, "Task");
    task.def_static("from_arrays", &from_arrays, "variable_facts"_a, "preconditions"_a, "adds"_a, "deletes"_a,
                    "costs"_a, "effects"_a, "initial"_a, "goal"_a, "goal_reachable"_a = true);

    task.def_prop_ro("num_facts", &Task::num_facts);
    task.def_prop_ro("num_operators", &Task::num_operators);
    task.def_prop_ro("num_variables", &Task::num_variables);
    task.def_prop_ro("num_words", [](const CoreTask& t) { return t.packer.num_words(); });
    task.def_prop_ro("initial", [](const CoreTask& t) { return t.initial; });
    task.def_prop_ro("goal", [](const CoreTask& t) { return t.goal; });
    task.def_prop_ro("goal_reachable", [](const CoreTask& t) { return t.goal_reachable; });

    auto fact_row = [&](const char* name, Table<std::int32_t> Task::*table) {
        task.def(
            name,
            [table](const CoreTask& t, FactId fact) {
                const auto row = (t.*table)[check_fact(t, fact)];
                return Ints(row.begin(), row.end());
            },
            "fact"_a);
    };
    fact_row("fact_arguments", &Task::fact_arguments);
    task.def("fact_predicate", [](const CoreTask& t, FactId f) { return t.fact_predicate[check_fact(t, f)]; }, "fact"_a);
    task.def("fact_variable", [](const CoreTask& t, FactId f) { return t.fact_variable[check_fact(t, f)]; }, "fact"_a);

    auto operator_row = [&](const char* name, Table<std::int32_t> Task::*table) {
        task.def(
            name,
            [table](const CoreTask& t, OperatorId op) {
                const auto row = (t.*table)[check_operator(t, op)];
                return Ints(row.begin(), row.end());
            },
            "operator"_a);
    };
    operator_row("operator_arguments", &Task::operator_arguments);
    operator_row("preconditions", &Task::preconditions);
    operator_row("adds", &Task::adds);
    operator_row("deletes", &Task::deletes);
    task.def("effects", &effects_of, "operator"_a);
    task.def("cost", [](const CoreTask& t, OperatorId op) { return t.cost[check_operator(t, op)]; }, "operator"_a);
    task.def("operator_schema", [](const CoreTask& t, OperatorId op) { return t.operator_schema[check_operator(t, op)]; },
             "operator"_a);
    task.def("variable_facts", [](const CoreTask& t, VariableId v) {
        if (v < 0 || v >= t.num_variables()) throw nb::index_error("no such variable");
        const auto row = t.variable_facts[v];
        return Ints(row.begin(), row.end());
    }, "variable"_a);

    task.def("find_fact", [](CoreTask& t, std::int32_t predicate, const Ints& arguments) {
        return t.index.find_fact(predicate, arguments);
    }, "predicate"_a, "arguments"_a);
    task.def("find_operators", [](CoreTask& t, std::int32_t schema, const Ints& arguments) {
        const auto found = t.index.find_operators(schema, arguments);
        return Ints(found.begin(), found.end());
    }, "schema"_a, "arguments"_a);

    task.def("pack", &pack, "facts"_a);
    task.def("true_facts", &true_facts, "state"_a);
    task.def("holds", &holds, "state"_a, "facts"_a);
    task.def("successor", &successor, "state"_a, "operator"_a);
    task.def("follow", &follow, "state"_a, "operators"_a);
    task.def("is_applicable", [](const CoreTask& t, const nb::bytes& state, OperatorId op) {
        return t.index.is_applicable(t.packer, to_words(t, state).data(), check_operator(t, op));
    }, "state"_a, "operator"_a);
    task.def("applicable", [](CoreTask& t, const nb::bytes& state) {
        return t.index.applicable(t.packer, to_words(t, state).data());
    }, "state"_a);

    task.def("array", [](nb::handle self, const std::string& name) {
        const Ints& values = array_named(nb::cast<const CoreTask&>(self), name);
        static const std::int32_t nothing = 0;  // an array needs an address, even without elements
        return nb::ndarray<nb::memview, const std::int32_t, nb::ndim<1>>(
            values.empty() ? &nothing : values.data(), {values.size()}, self);
    }, "name"_a);

    module.def("ground", &ground, "structure"_a, "initial"_a, "num_initial"_a, "function_arguments"_a,
               "function_values"_a, "memory_limit_bytes"_a);
    module.attr("AUXILIARY") = auxiliary;
}
