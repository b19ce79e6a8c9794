#include "labelling/team_tables.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include "labelling/distances.hpp"
#include "task/task_index.hpp"

namespace explicable {
namespace {

std::vector<std::uint8_t> human_operators(const Task& task, const std::vector<std::uint8_t>& is_human) {
    std::vector<std::uint8_t> flags(static_cast<std::size_t>(task.num_operators()));
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        const auto arguments = task.operator_arguments[op];
        flags[op] = !arguments.empty() && static_cast<std::size_t>(arguments[0]) < is_human.size() &&
                    is_human[arguments[0]];
    }
    return flags;
}

// Three bits for each fact (Bloom 1970).
std::uint32_t mask_of(std::span<const FactId> facts) {
    std::uint32_t mask = 0;
    for (const auto fact : facts) {
        const auto mixed = static_cast<std::uint32_t>(fact) * 0x9E3779B1u;
        for (const int shift : {27, 22, 17}) mask |= std::uint32_t{1} << (mixed >> shift & 31);
    }
    return mask;
}

}  // namespace

bool translate_objects(std::span<const std::int32_t> arguments, const std::vector<std::int32_t>& object,
                       std::vector<std::int32_t>& translated) {
    translated.clear();
    for (const auto argument : arguments) translated.push_back(object[argument]);
    return std::ranges::find(translated, -1) == translated.end();
}

std::vector<FactId> find_mental_facts(const Task& composite, const Task& mental, const MentalNames& names) {
    TaskIndex in_mental_task(mental);
    std::vector<std::int32_t> translated;
    std::vector<FactId> mental_fact;
    for (FactId fact = 0; fact < composite.num_facts(); ++fact) {
        const auto predicate = composite.fact_predicate[fact];
        if (predicate == auxiliary) {
            mental_fact.push_back(-1);
            continue;
        }
        const auto positive = predicate < 0 ? ~predicate : predicate;
        if (static_cast<std::size_t>(positive) >= names.predicate.size())
            throw std::invalid_argument("a predicate has no name");
        const auto head = names.predicate[positive];
        const bool known = head >= 0 && translate_objects(composite.fact_arguments[fact], names.object, translated);
        mental_fact.push_back(known ? in_mental_task.find_fact(predicate < 0 ? ~head : head, translated) : -1);
    }
    return mental_fact;
}

TeamTables::TeamTables(const Task& composite, const Task& mental, const std::vector<FactId>& goal,
                       const MentalNames& names, const std::vector<std::uint8_t>& human_objects)
    : goals(goal) {
    const auto num_operators = composite.num_operators();
    for (const auto fact : goals)
        if (fact < 0 || fact >= composite.num_facts()) throw std::invalid_argument("a goal is no fact of the task");
    num_schemas = static_cast<int>(names.schema.size());
    TeamStep none;
    none.schema = num_schemas;
    steps_.push_back(none);
    marks_.push_back({.adds = ~std::uint32_t{0}});
    arity.resize(names.schema.size());
    if (names.object.size() != human_objects.size()) throw std::invalid_argument("one flag an object is needed");
    for (OperatorId op = 0; op < num_operators; ++op) {
        if (composite.operator_schema[op] >= num_schemas) throw std::invalid_argument("a schema has no name");
        for (const auto argument : composite.operator_arguments[op])
            if (static_cast<std::size_t>(argument) >= names.object.size())
                throw std::invalid_argument("an object has no name");
        const auto count = composite.operator_arguments[op].size();
        max_arity = std::max(max_arity, count);
        if (const auto schema = composite.operator_schema[op]; schema >= 0) arity[schema] = std::max(arity[schema], count);
    }
    deletes_ = composite.deletes;
    const auto human = human_operators(composite, human_objects);
    TaskIndex in_mental_task(mental);
    std::vector<std::int32_t> translated;
    for (OperatorId op = 0; op < num_operators; ++op) {
        const auto objects = composite.operator_arguments[op];
        const auto schema = composite.operator_schema[op], head = schema < 0 ? -1 : names.schema[schema];
        adds_.push_back(all_adds(composite, op));
        TeamStep step;
        step.schema = schema;
        step.in_mental = head >= 0 && translate_objects(objects, names.object, translated) &&
                         !in_mental_task.find_operators(head, translated).empty();
        std::ranges::copy(objects.first(std::min(objects.size(), kMaxArguments)), step.arguments.begin());
        has_auxiliary_ |= schema < 0;
        steps_.push_back(step);
        marks_.push_back({.adds = adds_[op].empty() ? ~std::uint32_t{0} : mask_of(adds_[op]),
                          .deletes = mask_of(deletes_[op]),
                          .is_human = human[op] != 0});
    }

    for (const auto fact : goals) places_of_goals_.push_back({composite.fact_variable[fact], composite.fact_value[fact]});
    find_requests(composite);
    find_goals(composite);

    std::vector<std::uint8_t> mental_objects;
    for (std::size_t object = 0; object < names.object.size(); ++object) {
        const auto theirs = names.object[object];
        if (theirs < 0) continue;
        if (static_cast<std::size_t>(theirs) >= mental_objects.size()) mental_objects.resize(theirs + 1);
        mental_objects[theirs] = human_objects[object];
    }
    const Measure measure(composite, mental, find_mental_facts(composite, mental, names), human, human_operators(mental, mental_objects));
    measure_requests(measure);
    measure_goals(measure);
}

// A human step asks by the atoms that it adds, that name an object, that some robot's operator needs, and that no human
// step with other arguments (the agent aside) adds; model/requests.py holds the same rule.
void TeamTables::find_requests(const Task& task) {
    std::vector<bool> needed(static_cast<std::size_t>(task.num_facts())), shared(needed);
    std::vector<OperatorId> first_adder(static_cast<std::size_t>(task.num_facts()), -1);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if ((*this)[op].schema < 0) continue;  // auxiliary: nobody's
        if (!marks(op).is_human) {
            for (const auto fact : task.preconditions[op]) needed[fact] = true;
            continue;
        }
        const auto own = task.operator_arguments[op].subspan(1);
        for (const auto fact : task.adds[op]) {
            if (first_adder[fact] < 0) first_adder[fact] = op;
            if (!std::ranges::equal(own, task.operator_arguments[first_adder[fact]].subspan(1))) shared[fact] = true;
        }
    }
    const auto is_asked_for = [&](FactId fact) {
        return needed[fact] && !shared[fact] && task.fact_predicate[fact] >= 0 && !task.fact_arguments[fact].empty();
    };
    std::map<std::vector<FactId>, std::int32_t> requests;
    std::vector<std::vector<std::int32_t>> requests_of_fact(static_cast<std::size_t>(task.num_facts()));
    asks_for.assign(static_cast<std::size_t>(task.num_operators()), -1);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if (!marks(op).is_human) continue;
        std::vector<FactId> facts;
        std::ranges::copy_if(task.adds[op], std::back_inserter(facts), is_asked_for);
        if (facts.empty()) continue;
        const auto [place, is_new] = requests.try_emplace(facts, num_requests());
        asks_for[op] = place->second;
        if (!is_new) continue;
        request_facts.push_back(facts);
        for (const auto fact : facts) requests_of_fact[fact].push_back(place->second);
    }
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        std::set<std::int32_t> fulfilled;
        if (!marks(op).is_human && (*this)[op].schema >= 0)
            for (const auto fact : task.preconditions[op])
                fulfilled.insert(requests_of_fact[fact].begin(), requests_of_fact[fact].end());
        fulfils.push_back(fulfilled);
        for (const auto request : fulfilled) marks_[op + 1].fulfils |= StepMarks::bit_of(request);
    }
}

bool TeamTables::stands(const Task& task, const State& state, std::int32_t request) const {
    return std::ranges::any_of(request_facts[request], [&](FactId fact) { return state.holds(task, fact); });
}

void TeamTables::find_goals(const Task& task) {
    std::vector<std::int32_t> goal_of_fact(static_cast<std::size_t>(task.num_facts()), -1), achieved;
    for (std::size_t goal = 0; goal < goals.size(); ++goal)
        goal_of_fact[goals[goal]] = static_cast<std::int32_t>(goal);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        achieved.clear();
        for (const auto fact : all_adds(task, op))
            if (goal_of_fact[fact] >= 0) achieved.push_back(goal_of_fact[fact]);
        achieves.push_back(achieved);
    }
}

bool TeamTables::surely_takes_back(OperatorId step, OperatorId earlier) const {
    return earlier >= 0 && !adds_[step].empty() && std::ranges::includes(deletes_[earlier], adds_[step]);
}

}  // namespace explicable
