#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <iterator>
#include <limits>
#include <new>
#include <stdexcept>

#include "bindings/bindings.hpp"
#include "bindings/callback_scorer.hpp"
#include "bindings/core_costs_to_go.hpp"
#include "bindings/core_task.hpp"
#include "bindings/questions.hpp"
#include "search/counting_scorer.hpp"
#include "search/heuristics.hpp"
#include "search/plan_improvement.hpp"
#include "search/relaxed_plan.hpp"
#include "search/solve.hpp"
#include "task/successor.hpp"

namespace {

using namespace explicable;

State initial_state(const Task& task) {
    State state{std::vector<std::int32_t>(task.num_variables(), 0)};
    for (const FactId fact : task.initial) state.values[task.fact_variable[fact]] = task.fact_value[fact];
    return state;
}

Preferred preferred_of(const std::string& name) {
    if (name == "none") return Preferred::none;
    if (name == "helpful") return Preferred::helpful;
    if (name == "relaxed plan") return Preferred::relaxed_plan;
    throw std::invalid_argument("unknown kind of preferred operators: " + name);
}

Closing closing_of(const std::string& name) {
    if (name == "state") return Closing::state;
    if (name == "context") return Closing::context;
    throw std::invalid_argument("unknown way of closing nodes: " + name);
}

void check_scorer(const CoreTask& task, const PathScorer* scorer) {
    if (scorer && !scorer->fits(task)) throw std::invalid_argument("the scorer belongs to another task");
}

// Handles pending signals (Ctrl-C), then asks whether the search is to end; it still hands over what it has.
bool is_to_end(const nb::callable& interrupted) {
    const nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) {  // a handler of the program's own raised
        PyErr_Clear();
        return true;
    }
    return nb::cast<bool>(interrupted());
}

SearchAnswer search(const CoreTask& task, const std::optional<nb::bytes>& initial,
                    const std::vector<FactId>& goal, const std::string& algorithm,
                    const std::string& heuristic, const std::string& preferred, bool lookahead, double weight,
                    std::uint64_t seed, const PathScorer* scorer, const std::string& closing, double alpha, bool ratio,
                    std::optional<std::int64_t> max_cost, const std::vector<std::vector<OperatorId>>& known_plans,
                    double gap, const nb::object& on_better, const nb::callable& interrupted,
                    double time_limit_s, std::optional<std::size_t> memory_limit_bytes,
                    std::optional<std::int64_t> max_evaluations) {
    check_scorer(task, scorer);
    SearchOptions options;
    options.algorithm = algorithm;
    options.heuristic = heuristic;
    options.preferred = preferred_of(preferred);
    options.lookahead = lookahead;
    options.weight = weight;
    options.seed = seed;
    options.labelled = {scorer, closing_of(closing)};
    options.alpha = alpha;
    options.ratio = ratio;
    if (max_cost) options.max_cost = *max_cost;
    options.known_plans = known_plans;
    options.gap = gap;
    if (!on_better.is_none()) {
        options.on_better = [&on_better](double objective) {
            const nb::gil_scoped_acquire gil;
            on_better(objective);
        };
    }
    Limits limits;
    limits.time_s = time_limit_s;
    if (memory_limit_bytes) limits.memory_bytes = *memory_limit_bytes;
    if (max_evaluations) limits.evaluations = *max_evaluations;
    State start = initial ? state_of(task, *initial) : initial_state(task);
    check_goal(task, goal);

    const nb::gil_scoped_release released;
    if (task.prepared.estimated_bytes() > limits.memory_bytes) throw std::bad_alloc();
    Monitor monitor(limits, [&interrupted] { return is_to_end(interrupted); });
    const Question question(task.prepared, std::move(start), goal);
    for (const auto& plan : known_plans) check_plan(question, plan);
    return solve(question, options, monitor);
}

// The question that a plan answers.
Question question_of(const CoreTask& task, const std::optional<nb::bytes>& initial, const std::vector<FactId>& goal, const std::vector<OperatorId>& plan) {
    check_goal(task, goal);
    Question question(task.prepared, initial ? state_of(task, *initial) : initial_state(task), goal);
    check_plan(question, plan);
    return question;
}

std::vector<OperatorId> eliminated(const CoreTask& task, const std::optional<nb::bytes>& initial,
                                   const std::vector<FactId>& goal, const std::vector<OperatorId>& plan) {
    const Question question = question_of(task, initial, goal, plan);
    const nb::gil_scoped_release released;
    return eliminate_actions(question, plan, std::numeric_limits<std::int64_t>::max());
}

std::vector<OperatorId> neighbouring(const CoreTask& task, const std::optional<nb::bytes>& initial,
                                     const std::vector<FactId>& goal, const std::vector<OperatorId>& plan,
                                     std::size_t max_transitions) {
    const Question question = question_of(task, initial, goal, plan);
    const nb::gil_scoped_release released;
    return search_neighbourhood(question, plan, max_transitions);
}

std::vector<OperatorId> applicable(const CoreTask& task, const nb::bytes& state) {
    std::vector<OperatorId> operators;
    task.prepared.successors().applicable(state_of(task, state), operators);
    return operators;
}

using OrderedPlan = std::pair<std::int32_t, std::vector<OperatorId>>;

std::optional<OrderedPlan> relaxed_plan(const CoreTask& task, const nb::bytes& state, const std::vector<FactId>& goal,
                                        bool unit_costs) {
    check_goal(task, goal);
    RelaxedPlanner planner(task.prepared, goal, unit_costs ? SupporterCost::unit : SupporterCost::plus_one);
    if (!planner.compute(state_of(task, state))) return std::nullopt;
    const auto plan = planner.ordered_plan();
    return OrderedPlan{planner.h_add(), {plan.begin(), plan.end()}};
}

std::vector<OperatorId> helpful(const CoreTask& task, const nb::bytes& bytes, const std::vector<FactId>& goal) {
    check_goal(task, goal);
    const State state = state_of(task, bytes);
    std::vector<OperatorId> operators, result;
    task.prepared.successors().applicable(state, operators);
    RelaxedPlanner planner(task.prepared, goal, SupporterCost::unit);
    if (planner.compute(state)) planner.helpful(operators, result);
    return result;
}

double heuristic_value(const CoreTask& task, const nb::bytes& state, const std::vector<FactId>& goal,
                       const std::string& name) {
    check_goal(task, goal);
    const Question question(task.prepared, state_of(task, state), goal);
    const auto heuristic = make_admissible(question, name);
    if (!heuristic) throw std::invalid_argument("unknown heuristic: " + name);
    return heuristic->evaluate(question.initial);
}

std::string outcome_name(const SearchAnswer& answer) {
    constexpr const char* names[] = {"solved", "unsolvable", "limit reached", "interrupted"};
    return names[static_cast<int>(answer.outcome)];
}

}  // namespace

void bind_search(nb::module_& module) {
    using namespace nb::literals;
    nb::class_<PathScorer>(module, "PathScorer", "Scores the steps of a path and a relaxed plan in labelled search.");
    nb::class_<CountingScorer, PathScorer>(module, "CountingScorer", "Each operator counts with a fixed weight.")
        .def(nb::init<std::vector<double>>(), "weights"_a);
    nb::class_<CallbackScorer, PathScorer>(module, "CallbackScorer", "Asks a Python object.")
        .def(nb::init<const CoreTask&, nb::object>(), "task"_a, "callbacks"_a, nb::keep_alive<1, 2>());
    nb::class_<SearchAnswer>(module, "SearchAnswer", "What a search found out.")
        .def_prop_ro("outcome", &outcome_name)
        .def_prop_ro("stop", [](const SearchAnswer& answer) { return std::string(name_of(answer.stop)); })
        .def_ro("plan", &SearchAnswer::plan)
        .def_ro("cost", &SearchAnswer::cost)
        .def_ro("objective", &SearchAnswer::objective)
        .def_ro("lower_bound", &SearchAnswer::lower_bound)
        .def_ro("is_optimal", &SearchAnswer::is_optimal)
        .def_ro("evaluations", &SearchAnswer::evaluations)
        .def_ro("expansions", &SearchAnswer::expansions)
        .def_ro("memory_bytes", &SearchAnswer::memory_bytes)
        .def_ro("search_s", &SearchAnswer::search_s);
    module.def("search", &search, "task"_a, "initial"_a.none(), "goal"_a, nb::kw_only(), "algorithm"_a,
               "heuristic"_a, "preferred"_a, "lookahead"_a, "weight"_a, "seed"_a, "scorer"_a.none(), "closing"_a, "alpha"_a,
               "ratio"_a, "max_cost"_a.none(), "known_plans"_a, "gap"_a, "on_better"_a.none(), "interrupted"_a, "time_limit_s"_a, "memory_limit_bytes"_a.none(),
               "max_evaluations"_a.none());
    nb::class_<CoreCostsToGo>(module, "CostsToGo", "Exact costs-to-go, found out and remembered.")
        .def(nb::init<const CoreTask&, std::size_t>(), "task"_a, "most"_a, nb::keep_alive<1, 2>())
        .def("cost", &CoreCostsToGo::cost, "state"_a, "goal"_a, "by"_a = -1)
        .def("first", &CoreCostsToGo::first, "state"_a, "goal"_a, "by"_a = -1)
        .def("way", &CoreCostsToGo::way, "state"_a, "goal"_a, "by"_a = -1)
        .def("learn", &CoreCostsToGo::learn, "state"_a, "goal"_a, "way"_a.none());
    module.def("eliminate_actions", &eliminated, "task"_a, "initial"_a.none(), "goal"_a, "plan"_a);
    module.def("search_neighbourhood", &neighbouring, "task"_a, "initial"_a.none(), "goal"_a, "plan"_a,
               "max_transitions"_a);
    module.def("applicable_operators", &applicable, "task"_a, "state"_a);
    module.def("relaxed_plan", &relaxed_plan, "task"_a, "state"_a, "goal"_a, "unit_costs"_a = true);
    module.def("helpful_operators", &helpful, "task"_a, "state"_a, "goal"_a);
    module.def("heuristic_value", &heuristic_value, "task"_a, "state"_a, "goal"_a, "name"_a);
}
