#include "labelling/team_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

namespace explicable {
namespace {

std::uint64_t mix(std::uint64_t x) {  // splitmix64
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

std::uint64_t fingerprint(std::int32_t head, std::span<const std::int32_t> arguments) {
    std::uint64_t key = mix(static_cast<std::uint32_t>(head));
    for (const auto argument : arguments) key = mix(key ^ static_cast<std::uint32_t>(argument));
    return key;
}

// Looks up facts or operators of the mental task by name.
class MentalIndex {
public:
    MentalIndex(const std::vector<std::int32_t>& heads, const Table<std::int32_t>& arguments)
        : heads_(heads), arguments_(arguments) {
        numbers_.reserve(heads.size());
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(heads.size()); ++i)
            numbers_.emplace(fingerprint(heads[i], arguments[i]), i);
    }
    std::int32_t find(std::int32_t head, std::span<const std::int32_t> arguments) const {
        const auto [begin, end] = numbers_.equal_range(fingerprint(head, arguments));
        for (auto it = begin; it != end; ++it)
            if (heads_[it->second] == head && std::ranges::equal(arguments_[it->second], arguments)) return it->second;
        return -1;
    }

private:
    const std::vector<std::int32_t>& heads_;
    const Table<std::int32_t>& arguments_;
    std::unordered_multimap<std::uint64_t, std::int32_t> numbers_;
};

bool translate(std::span<const std::int32_t> arguments, const std::vector<std::int32_t>& object,
               std::vector<std::int32_t>& translated) {
    translated.clear();
    for (const auto argument : arguments) translated.push_back(object[argument]);
    return std::ranges::find(translated, -1) == translated.end();
}

// What an operator may make true, conditional effects included.
std::vector<FactId> all_adds(const Task& task, OperatorId op) {
    const auto plain = task.adds[op];
    std::vector<FactId> facts(plain.begin(), plain.end());
    for (auto effect = task.effect_offsets[op]; effect < task.effect_offsets[op + 1]; ++effect)
        facts.insert(facts.end(), task.effect_adds[effect].begin(), task.effect_adds[effect].end());
    std::ranges::sort(facts);
    return facts;
}

// The preconditions that an operator uses up; all of them where it uses none up.
std::vector<FactId> used_up(const Task& task, OperatorId op) {
    const auto preconditions = task.preconditions[op];
    std::vector<FactId> used;
    std::ranges::set_intersection(preconditions, task.deletes[op], std::back_inserter(used));
    return used.empty() ? std::vector<FactId>(preconditions.begin(), preconditions.end()) : used;
}

// An operator leads from each precondition that it uses up to each fact that it adds. Distances count such
// transitions, backwards from a set of facts.
class TransitionGraph {
public:
    explicit TransitionGraph(const Task& task) : task_(task), adders_(task.num_facts()), users_(task.num_facts()) {
        for (OperatorId op = 0; op < task.num_operators(); ++op) {
            sources_.push_back(used_up(task, op));
            for (const auto fact : all_adds(task, op)) adders_[fact].push_back(op);
            for (const auto fact : task.preconditions[op]) users_[fact].push_back(op);
        }
    }
    const std::vector<OperatorId>& adders(FactId fact) const { return adders_[fact]; }
    const std::vector<OperatorId>& users(FactId fact) const { return users_[fact]; }

    // `distance` of each fact to the nearest of `queue`, whose own distances are set already (all alike).
    void measure(std::vector<FactId>& queue, std::vector<Distance>& distance) const {
        std::vector<bool> fired(static_cast<std::size_t>(task_.num_operators()));
        for (std::size_t next = 0; next < queue.size(); ++next) {
            const Distance farther = static_cast<Distance>(std::min<int>(distance[queue[next]] + 1, kNoWay - 1));
            for (const auto op : adders_[queue[next]]) {
                if (fired[op]) continue;
                fired[op] = true;
                for (const auto fact : sources_[op]) {
                    if (distance[fact] != kNoWay) continue;
                    distance[fact] = farther;
                    queue.push_back(fact);
                }
            }
        }
    }

private:
    const Task& task_;
    std::vector<std::vector<OperatorId>> adders_, users_;
    Table<FactId> sources_;
};

// Distance of every fact to what a request asks for: the other preconditions of the operators that need its fact.
std::vector<Distance> to_request(const Task& task, const TransitionGraph& graph, FactId request,
                                 const std::vector<std::uint8_t>& human_operator) {
    std::vector<Distance> distance(static_cast<std::size_t>(task.num_facts()), kNoWay);
    std::vector<FactId> queue;
    if (request < 0) return distance;
    for (const auto op : graph.users(request)) {
        if (human_operator[op]) continue;
        for (const auto fact : task.preconditions[op]) {
            if (fact == request || distance[fact] != kNoWay) continue;
            distance[fact] = 1;
            queue.push_back(fact);
        }
    }
    graph.measure(queue, distance);
    return distance;
}

// Distance of every fact to a goal: 0 for the goal itself, 1 for what its achievers need.
std::vector<Distance> to_goal(const Task& task, const TransitionGraph& graph, FactId goal) {
    std::vector<Distance> distance(static_cast<std::size_t>(task.num_facts()), kNoWay);
    if (goal < 0) return distance;
    distance[goal] = 0;
    std::vector<FactId> queue;
    for (const auto op : graph.adders(goal)) {
        for (const auto fact : task.preconditions[op]) {
            if (distance[fact] != kNoWay) continue;
            distance[fact] = 1;
            queue.push_back(fact);
        }
    }
    graph.measure(queue, distance);
    return distance;
}

std::vector<std::uint8_t> human_operators(const Task& task, const std::vector<std::uint8_t>& is_human) {
    std::vector<std::uint8_t> flags(static_cast<std::size_t>(task.num_operators()));
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        const auto arguments = task.operator_arguments[op];
        flags[op] = !arguments.empty() && static_cast<std::size_t>(arguments[0]) < is_human.size() &&
                    is_human[arguments[0]];
    }
    return flags;
}

Progress judge(Distance before, Distance after) {
    if (before == kNoWay) return after == kNoWay ? Progress::kUnconcerned : Progress::kNearer;
    if (after == kNoWay) return Progress::kNoWay;
    const int regret = after + 1 - before;
    if (regret < 0) return Progress::kShortcut;
    if (regret == 0) return Progress::kNearer;
    if (regret == 1) return Progress::kSame;
    return regret == 2 ? Progress::kFarther : Progress::kMuchFarther;
}

}  // namespace

TeamTables::TeamTables(const Task& composite, const Task& mental, const std::vector<FactId>& goal,
                       const MentalNames& names, const std::vector<std::uint8_t>& human_objects)
    : goals(goal) {
    const auto num_operators = composite.num_operators();
    for (const auto fact : goals)
        if (fact < 0 || fact >= composite.num_facts()) throw std::invalid_argument("a goal is no fact of the task");
    num_schemas = static_cast<int>(names.schema.size());
    if (names.object.size() != human_objects.size()) throw std::invalid_argument("one flag an object is needed");
    for (OperatorId op = 0; op < num_operators; ++op) {
        if (composite.operator_schema[op] >= num_schemas) throw std::invalid_argument("a schema has no name");
        for (const auto argument : composite.operator_arguments[op])
            if (static_cast<std::size_t>(argument) >= names.object.size())
                throw std::invalid_argument("an object has no name");
        max_arity = std::max(max_arity, static_cast<int>(composite.operator_arguments[op].size()));
    }
    schema = composite.operator_schema;
    deletes = composite.deletes;
    is_human = human_operators(composite, human_objects);
    arguments.assign(static_cast<std::size_t>(num_operators) * max_arity, -1);

    const MentalIndex mental_operators(mental.operator_schema, mental.operator_arguments);
    std::vector<std::int32_t> translated;
    for (OperatorId op = 0; op < num_operators; ++op) {
        const auto objects = composite.operator_arguments[op];
        std::ranges::copy(objects, arguments.begin() + static_cast<std::ptrdiff_t>(op) * max_arity);
        const auto head = schema[op] < 0 ? -1 : names.schema[schema[op]];
        in_mental.push_back(head >= 0 && translate(objects, names.object, translated) &&
                            mental_operators.find(head, translated) >= 0);
        adds.push_back(all_adds(composite, op));
    }

    const MentalIndex mental_facts(mental.fact_predicate, mental.fact_arguments);
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
        const bool known = head >= 0 && translate(composite.fact_arguments[fact], names.object, translated);
        mental_fact.push_back(known ? mental_facts.find(predicate < 0 ? ~head : head, translated) : -1);
    }
    find_requests(composite);
    find_goals(composite);

    std::vector<std::uint8_t> mental_objects;
    for (std::size_t object = 0; object < names.object.size(); ++object) {
        const auto theirs = names.object[object];
        if (theirs < 0) continue;
        if (static_cast<std::size_t>(theirs) >= mental_objects.size()) mental_objects.resize(theirs + 1);
        mental_objects[theirs] = human_objects[object];
    }
    measure(composite, mental, mental_fact, human_operators(mental, mental_objects));
    find_places(composite);
    find_tours(composite);
}

// A human step asks for a fact that names an object, that some robot's operator needs, and that no human step with
// other arguments (the agent aside) adds.
void TeamTables::find_requests(const Task& task) {
    std::vector<bool> needed(static_cast<std::size_t>(task.num_facts())), shared(needed);
    std::vector<OperatorId> first_adder(static_cast<std::size_t>(task.num_facts()), -1);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if (!is_human[op]) {
            for (const auto fact : task.preconditions[op]) needed[fact] = true;
            continue;
        }
        const auto own = task.operator_arguments[op].subspan(1);
        for (const auto fact : all_adds(task, op)) {
            if (first_adder[fact] < 0) first_adder[fact] = op;
            if (!std::ranges::equal(own, task.operator_arguments[first_adder[fact]].subspan(1))) shared[fact] = true;
        }
    }
    std::vector<std::int32_t> request_of_fact(static_cast<std::size_t>(task.num_facts()), -1);
    asks_for.assign(static_cast<std::size_t>(task.num_operators()), -1);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if (!is_human[op]) continue;
        for (const auto fact : all_adds(task, op)) {
            if (!needed[fact] || shared[fact] || task.fact_arguments[fact].empty()) continue;
            if (request_of_fact[fact] < 0) {
                request_of_fact[fact] = num_requests();
                request_facts.push_back(fact);
            }
            asks_for[op] = request_of_fact[fact];
            break;
        }
    }
    std::vector<std::int32_t> fulfilled;
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        fulfilled.clear();
        if (!is_human[op])
            for (const auto fact : task.preconditions[op])
                if (request_of_fact[fact] >= 0) fulfilled.push_back(request_of_fact[fact]);
        fulfils.push_back(fulfilled);
    }
}

void TeamTables::find_goals(const Task& task) {
    std::vector<std::int32_t> goal_of_fact(static_cast<std::size_t>(task.num_facts()), -1), achieved;
    for (int goal = 0; goal < num_goals(); ++goal) goal_of_fact[goals[goal]] = goal;
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        achieved.clear();
        for (const auto fact : all_adds(task, op))
            if (goal_of_fact[fact] >= 0) achieved.push_back(goal_of_fact[fact]);
        achieves.push_back(achieved);
    }
}

void TeamTables::measure(const Task& composite, const Task& mental, const std::vector<FactId>& mental_fact,
                         const std::vector<std::uint8_t>& mental_human) {
    const auto width = num_targets();
    const auto num_facts = static_cast<std::size_t>(composite.num_facts());
    if (num_facts > 0 && 2 * width > kMaxDistances / num_facts)
        throw std::length_error("too many facts times goals and requests");
    const TransitionGraph own_graph(composite), mental_graph(mental);
    distances_.assign(2 * width * num_facts, kNoWay);
    for (std::size_t target = 0; target < width; ++target) {
        const bool is_request = target < request_facts.size();
        const FactId fact = is_request ? request_facts[target] : goals[target - request_facts.size()];
        const auto own = is_request ? to_request(composite, own_graph, fact, is_human)
                                    : to_goal(composite, own_graph, fact);
        const auto theirs = is_request ? to_request(mental, mental_graph, mental_fact[fact], mental_human)
                                       : to_goal(mental, mental_graph, mental_fact[fact]);
        for (std::size_t i = 0; i < num_facts; ++i) {
            auto* const place = distances_.data() + 2 * i * width + target;
            if (mental_fact[i] >= 0) place[0] = theirs[mental_fact[i]];
            place[width] = own[i];
        }
    }
}

void TeamTables::find_places(const Task& task) {
    const auto leads_nowhere = [this](FactId fact) {
        const std::span all(row(fact, Model::kMental), 2 * num_targets());
        return std::ranges::all_of(all, [](Distance distance) { return distance == kNoWay; });
    };
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        auto from = used_up(task, op), to = all_adds(task, op);
        std::erase_if(from, leads_nowhere);
        std::erase_if(to, leads_nowhere);
        sources_.push_back(from);
        sinks_.push_back(to);
    }
}

// tours_[open][first] = steps that the other open goals take after `first`, one after another in the best order. A
// goal that does not depend on where the one before leaves off adds nothing.
void TeamTables::find_tours(const Task& task) {
    const auto count = goals.size();
    if (count > kMaxTourGoals) return;
    std::vector<int> between(count * count, kNoWay);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if (achieves[op].empty()) continue;
        std::vector<FactId> after = all_adds(task, op);
        std::ranges::set_difference(task.preconditions[op], task.deletes[op], std::back_inserter(after));
        for (const auto goal : achieves[op])
            for (std::size_t other = 0; other < count; ++other)
                for (const auto fact : after)
                    between[goal * count + other] =
                        std::min<int>(between[goal * count + other],
                                      row(fact, Model::kMental)[request_facts.size() + other]);
    }
    std::ranges::replace(between, static_cast<int>(kNoWay), 0);
    tours_.assign(count << count, 0);
    for (std::size_t open = 1; open < std::size_t{1} << count; ++open) {
        for (std::size_t first = 0; first < count; ++first) {
            const std::size_t others = open & ~(std::size_t{1} << first);
            if (others == open || others == 0) continue;
            int best = kNoWay - 1;
            for (std::size_t next = 0; next < count; ++next)
                if (others >> next & 1)
                    best = std::min(best, between[first * count + next] + tours_[others * count + next]);
            tours_[open * count + first] = static_cast<Distance>(best);
        }
    }
}

Distance TeamTables::nearest_target(std::span<const FactId> facts, Model model, std::size_t target) const {
    Distance nearest = kNoWay;
    for (const auto fact : facts) nearest = std::min(nearest, row(fact, model)[target]);
    return nearest;
}

Distance TeamTables::nearest_goal(std::span<const FactId> facts, Model model,
                                  std::span<const Distance> closed) const {
    Distance nearest = kNoWay;
    for (const auto fact : facts) {
        const Distance* const distance = row(fact, model) + request_facts.size();
        for (std::size_t goal = 0; goal < closed.size(); ++goal)
            nearest = std::min(nearest, static_cast<Distance>(distance[goal] | closed[goal]));
    }
    return nearest;
}

Distance TeamTables::mission(std::span<const FactId> facts, std::size_t open) const {
    int best = kNoWay;
    for (const auto fact : facts) {
        const Distance* const distance = row(fact, Model::kMental) + request_facts.size();
        for (std::size_t goal = 0; goal < goals.size(); ++goal)
            if ((open >> goal & 1) && distance[goal] != kNoWay)
                best = std::min(best, std::min(distance[goal] + tours_[open * goals.size() + goal], kNoWay - 1));
    }
    return static_cast<Distance>(best);
}

bool TeamTables::achieves_open_goal(OperatorId step, std::span<const Distance> closed) const {
    return std::ranges::any_of(achieves[step], [&](std::int32_t goal) { return closed[goal] == 0; });
}

bool TeamTables::takes_back(OperatorId step, OperatorId earlier) const {
    return earlier >= 0 && !adds[step].empty() && std::ranges::includes(deletes[earlier], adds[step]);
}

Progress TeamTables::toward_request(Model model, OperatorId step, int request) const {
    if (request < 0) return Progress::kNoTarget;
    if (std::ranges::find(fulfils[step], request) != fulfils[step].end()) return Progress::kDone;
    const auto target = static_cast<std::size_t>(request);
    return judge(nearest_target(sources_[step], model, target), nearest_target(sinks_[step], model, target));
}

Progress TeamTables::toward_nearest_goal(Model model, OperatorId step, std::span<const Distance> closed) const {
    if (std::ranges::find(closed, Distance{0}) == closed.end()) return Progress::kNoTarget;
    if (achieves_open_goal(step, closed)) return Progress::kDone;
    return judge(nearest_goal(sources_[step], model, closed), nearest_goal(sinks_[step], model, closed));
}

Progress TeamTables::toward_mission(OperatorId step, std::span<const Distance> closed) const {
    if (tours_.empty()) return toward_nearest_goal(Model::kMental, step, closed);
    if (achieves_open_goal(step, closed)) return Progress::kDone;
    std::size_t open = 0;
    for (std::size_t goal = 0; goal < closed.size(); ++goal) open |= static_cast<std::size_t>(closed[goal] == 0) << goal;
    return open == 0 ? Progress::kNoTarget : judge(mission(sources_[step], open), mission(sinks_[step], open));
}

}  // namespace explicable
