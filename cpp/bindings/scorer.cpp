// Feature tables of a team task, and the scorer that a labelled search asks.
#include "labelling/scorer.hpp"
#include "labelling/telling.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/core_task.hpp"

namespace explicable {
namespace {

using Ints = std::vector<std::int32_t>;
using Values = std::array<std::int32_t, kMaxValues>;

// A scorer together with the packing of its task's states, in which Python holds them.
struct BoundScorer final : Scorer {
    BoundScorer(const CoreTask& core, std::shared_ptr<const TeamTables> tables, const FeatureWeights& weights,
                std::vector<double> own, Transitions transitions, bool expected)
        : Scorer(core, std::move(tables), weights, std::move(own), transitions, expected), task(core) {}
    const CoreTask& task;
};

// Likewise.
struct BoundChoices final : HumanChoices {
    BoundChoices(const CoreTask& core, const Task& mental, const MentalNames& names, std::shared_ptr<const TeamTables> tables)
        : HumanChoices(core, mental, names, std::move(tables)), core(core) {}
    const CoreTask& core;
};

std::shared_ptr<TeamTables> make_tables(const CoreTask& composite, const CoreTask& mental, const Ints& goal,
                                        Ints schemas, Ints predicates, Ints objects,
                                        const std::vector<std::uint8_t>& is_human) {
    nb::gil_scoped_release release;
    return std::make_shared<TeamTables>(composite, mental, goal,
                                        MentalNames{std::move(schemas), std::move(predicates), std::move(objects)},
                                        is_human);
}

State unpack(const CoreTask& task, const nb::bytes& packed) {
    if (packed.size() != task.packer.num_words() * sizeof(Word)) throw std::invalid_argument("not a state of this task");
    std::vector<Word> words(task.packer.num_words());
    if (!words.empty()) std::memcpy(words.data(), packed.c_str(), packed.size());
    return task.packer.unpack(words.data());
}

std::shared_ptr<BoundChoices> make_choices(const CoreTask& composite, const CoreTask& mental,
                                           std::shared_ptr<const TeamTables> tables, Ints schemas, Ints predicates,
                                           Ints objects) {
    if (tables->num_operators() != composite.num_operators()) throw std::invalid_argument("tables of another task");
    nb::gil_scoped_release release;
    return std::make_shared<BoundChoices>(composite, mental,
                                          MentalNames{std::move(schemas), std::move(predicates), std::move(objects)},
                                          std::move(tables));
}

using Option = std::tuple<OperatorId, std::int32_t, bool, std::int32_t, bool>;

std::vector<Option> list_options(const BoundChoices& choices, const nb::bytes& state, const Ints& open) {
    std::vector<HumanOption> options;
    choices.list(unpack(choices.core, state), open, options);
    std::vector<Option> result;
    for (const HumanOption& option : options)
        result.emplace_back(option.step, option.request, option.distance != kNoWay, option.rank, option.repeats);
    return result;
}

OperatorId check_operator(const TeamTables& tables, OperatorId step) {
    if (step < 0 || step >= tables.num_operators()) throw nb::index_error("no such operator");
    if (tables[step].schema < 0) throw nb::index_error("an auxiliary operator is no step");
    return step;
}

Ints row(const Table<std::int32_t>& table, OperatorId step) { return Ints(table[step].begin(), table[step].end()); }

const std::byte* check_context(const BoundScorer& scorer, const nb::bytes& context) {
    const auto* const bytes = reinterpret_cast<const std::byte*>(context.c_str());
    if (!scorer.is_sound({bytes, context.size()})) throw std::invalid_argument("not a context of this scorer");
    return bytes;
}

std::unique_ptr<BoundScorer> make_scorer(const CoreTask& task, std::shared_ptr<const TeamTables> tables,
                                         const std::vector<std::tuple<int, Values, double>>& weights,
                                         const Scorer::Transitions& transitions, bool expected,
                                         std::vector<double> own, double unfamiliar) {
    if (tables->num_operators() != task.num_operators()) throw std::invalid_argument("tables of another task");
    FeatureWeights table(tables->num_schemas, tables->max_arity, unfamiliar);
    for (const auto& [feature_template, values, weight] : weights) table.set(feature_template, values, weight);
    return std::make_unique<BoundScorer>(task, std::move(tables), table, std::move(own), transitions, expected);
}

std::unique_ptr<CoreTask> tell(const CoreTask& task, std::int32_t num_sets,
                               const std::vector<std::tuple<std::int32_t, std::int32_t, std::int32_t>>& tellings) {
    std::vector<Telling> edges;
    for (const auto& [from, to, schema] : tellings) edges.push_back({from, to, schema});
    return std::make_unique<CoreTask>(with_telling(task, num_sets, edges));
}

std::unique_ptr<TellingScorer> make_telling_scorer(const CoreTask& task, const std::vector<const BoundScorer*>& scorers,
                                                   double price) {
    if (!(price >= 0) || !std::isfinite(price)) throw std::invalid_argument("a price must be finite and at least 0");
    if (scorers.empty()) throw std::invalid_argument("a scorer is needed for each set");
    std::vector<Scorer> copies;
    for (const BoundScorer* scorer : scorers) {
        if (!scorer || &scorer->task != &task) throw std::invalid_argument("a scorer of another task");
        copies.push_back(*scorer);
    }
    return std::make_unique<TellingScorer>(task, std::move(copies), price);
}

}  // namespace
}  // namespace explicable

void bind_scorer(nb::module_& module) {
    using namespace explicable;
    using namespace nb::literals;

    nb::class_<TeamTables>(module, "TeamTables", "What features see of a team task.")
        .def(nb::new_(&make_tables), "composite"_a, "mental"_a, "goal"_a, "schemas"_a, "predicates"_a, "objects"_a,
             "is_human"_a)
        .def_prop_ro("request_facts",
                     [](const TeamTables& t) {
                         std::vector<Ints> rows;
                         for (int request = 0; request < t.num_requests(); ++request)
                             rows.emplace_back(t.request_facts[request].begin(), t.request_facts[request].end());
                         return rows;
                     })
        .def_ro("max_arity", &TeamTables::max_arity)
        .def("is_human", [](const TeamTables& t, OperatorId o) { return t.marks(check_operator(t, o)).is_human; })
        .def("is_believed", [](const TeamTables& t, OperatorId o) { return t[check_operator(t, o)].in_mental; })
        .def("asks_for", [](const TeamTables& t, OperatorId o) { return t.asks_for[check_operator(t, o)]; })
        .def("fulfils", [](const TeamTables& t, OperatorId o) { return row(t.fulfils, check_operator(t, o)); })
        .def("achieves", [](const TeamTables& t, OperatorId o) { return row(t.achieves, check_operator(t, o)); })
        .def("takes_back",
             [](const TeamTables& t, OperatorId step, OperatorId earlier) {
                 return t.takes_back(check_operator(t, step), check_operator(t, earlier));
             })
        .def("toward_request",
             [](const TeamTables& t, OperatorId step, int request) {
                 if (request < -1 || request >= t.num_requests()) throw nb::index_error("no such request");
                 const auto progress = t.toward_request(check_operator(t, step), request);
                 return std::tuple(static_cast<int>(progress.mental()), static_cast<int>(progress.own()));
             },
             "step"_a, "request"_a)
        .def("toward_goals",
             [](const TeamTables& t, OperatorId step, const std::vector<bool>& fulfilled) {
                 if (fulfilled.size() != t.goals.size()) throw std::invalid_argument("one flag a goal is needed");
                 OpenGoals goals(fulfilled.size());
                 for (std::size_t goal = 0; goal < fulfilled.size(); ++goal)
                     if (fulfilled[goal]) goals.close(goal);
                 const auto progress = t.toward_goals(check_operator(t, step), goals);
                 return std::tuple(static_cast<int>(progress.mental()), static_cast<int>(progress.own()),
                                   static_cast<int>(progress.mission()));
             },
             "step"_a, "fulfilled"_a);

    nb::class_<BoundChoices>(module, "HumanChoices", "What a human can do in a state, with the features of each choice.")
        .def(nb::new_(&make_choices), "composite"_a, "mental"_a, "tables"_a, "schemas"_a, "predicates"_a, "objects"_a,
             nb::keep_alive<0, 1>())
        // (operator, request or -1, whether there seems to be a way, rank of its length, whether it is open already)
        .def("options", &list_options, "state"_a, "open"_a);

    // The base PathScorer is bound with the search.
    nb::class_<BoundScorer, PathScorer>(module, "Scorer", "A labeller compiled for one team task.")
        .def(nb::new_(&make_scorer), "task"_a, "tables"_a, "weights"_a, "transitions"_a, "expected"_a,
             "own"_a = std::vector<double>{}, "unfamiliar"_a = 0.0, nb::keep_alive<0, 1>())
        .def("starting_at",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 const auto* const bytes = check_context(scorer, context);
                 auto moved = std::make_unique<BoundScorer>(scorer);
                 moved->start_at({bytes, context.size()});
                 return moved;
             },
             "context"_a, nb::keep_alive<0, 1>())
        .def("charging",
             [](const BoundScorer& scorer, std::shared_ptr<const BoundChoices> choices, const HumanWeights& weights,
                double price) {
                 if (&choices->core != &scorer.task) throw std::invalid_argument("choices of another task");
                 if (!(price >= 0) || !std::isfinite(price)) throw std::invalid_argument("a price must be finite and at least 0");
                 for (const double weight : weights)
                     if (!std::isfinite(weight)) throw std::invalid_argument("a weight is not finite");
                 auto charging = std::make_unique<BoundScorer>(scorer);
                 charging->charge_for(std::move(choices), weights, price);
                 return charging;
             },
             "choices"_a, "weights"_a, "price"_a, nb::keep_alive<0, 1>())
        .def("root",
             [](const BoundScorer& scorer, const nb::bytes& state) {
                 std::vector<std::byte> context(scorer.context_size());
                 scorer.root(unpack(scorer.task, state), context.data());
                 return nb::bytes(context.data(), context.size());
             },
             "state"_a)
        .def("extend",
             [](const BoundScorer& scorer, const nb::bytes& parent, OperatorId step, const nb::bytes& before,
                const nb::bytes& after) {
                 std::vector<std::byte> context(scorer.context_size());
                 if (step < 0 || step >= scorer.task.num_operators()) throw nb::index_error("no such operator");
                 scorer.extend(check_context(scorer, parent), step, unpack(scorer.task, before),
                               unpack(scorer.task, after), context.data());
                 return nb::bytes(context.data(), context.size());
             },
             "parent"_a, "step"_a, "before"_a, "after"_a)
        .def("score",
             [](const BoundScorer& scorer, const nb::bytes& context, const nb::bytes& state, const Ints& relaxed_plan) {
                 for (const auto step : relaxed_plan)
                     if (step < 0 || step >= scorer.task.num_operators()) throw nb::index_error("no such operator");
                 const auto result =
                     scorer.score(check_context(scorer, context), unpack(scorer.task, state), relaxed_plan);
                 return std::tuple(result.num_inexplicable, result.variance, result.num_steps);
             },
             "context"_a, "state"_a, "relaxed_plan"_a)
        .def("count",
             [](const BoundScorer& scorer, const nb::bytes& context, const nb::bytes& state, const Ints& relaxed_plan) {
                 for (const auto step : relaxed_plan)
                     if (step < 0 || step >= scorer.task.num_operators()) throw nb::index_error("no such operator");
                 return scorer.counter()->count(check_context(scorer, context), unpack(scorer.task, state), relaxed_plan);
             },
             "context"_a, "state"_a, "relaxed_plan"_a)
        .def("count_child",
             [](const BoundScorer& scorer, const nb::bytes& parent, OperatorId step, const nb::bytes& before, const nb::bytes& after,
                const Ints& relaxed_plan) {
                 const auto is_operator = [&](OperatorId op) { return op >= 0 && op < scorer.task.num_operators(); };
                 if (!is_operator(step) || !std::ranges::all_of(relaxed_plan, is_operator)) throw nb::index_error("no such operator");
                 const auto* const bytes = check_context(scorer, parent);
                 const State at = unpack(scorer.task, before), to = unpack(scorer.task, after);
                 const auto counter = scorer.counter();
                 if (ChildCounter* const children = counter->of_children()) {
                     children->start(bytes, at);
                     return children->count(step, to, relaxed_plan);
                 }
                 std::vector<std::byte> child(scorer.context_size());
                 scorer.extend(bytes, step, at, to, child.data());
                 return counter->count(child.data(), to, relaxed_plan);
             },
             "parent"_a, "step"_a, "before"_a, "after"_a, "relaxed_plan"_a)
        .def("charge",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 return scorer.charge(check_context(scorer, context));
             },
             "context"_a)
        .def("closing_key",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 return scorer.closing_key(check_context(scorer, context));
             },
             "context"_a)
        .def("lead",
             [](const BoundScorer& scorer, const nb::bytes& a, const nb::bytes& b, const nb::bytes& state) {
                 return scorer.lead(check_context(scorer, a), check_context(scorer, b), unpack(scorer.task, state));
             },
             "a"_a, "b"_a, "state"_a)
        .def("least_count",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 return scorer.least_count(check_context(scorer, context));
             },
             "context"_a)
        .def("least_growth",
             [](const BoundScorer& scorer, const nb::bytes& parent, OperatorId step, const nb::bytes& child) {
                 if (step < 0 || step >= scorer.task.num_operators()) throw nb::index_error("no such operator");
                 return scorer.least_growth(check_context(scorer, parent), step, check_context(scorer, child));
             },
             "parent"_a, "step"_a, "child"_a)
        .def("least_end",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 return scorer.least_end(check_context(scorer, context));
             },
             "context"_a)
        .def("outlook_key",
             [](const BoundScorer& scorer, const nb::bytes& context) {
                 return scorer.outlook_key(check_context(scorer, context));
             },
             "context"_a)
        .def("widen",
             [](const BoundScorer& scorer, const nb::bytes& context, const nb::bytes& other) {
                 const std::byte* const bytes = check_context(scorer, context);
                 std::vector<std::byte> widened(bytes, bytes + context.size());
                 scorer.widen(widened.data(), check_context(scorer, other));
                 return nb::bytes(widened.data(), widened.size());
             },
             "context"_a, "other"_a);

    module.def("with_telling", &tell, "task"_a, "num_sets"_a, "tellings"_a,
               "The task in which telling is a step: (from set, to set, schema) each.");
    nb::class_<TellingScorer, PathScorer>(module, "TellingScorer", "One scorer for each set that can have been told.")
        .def(nb::new_(&make_telling_scorer), "task"_a, "scorers"_a, "price"_a, nb::keep_alive<0, 1>());
}
