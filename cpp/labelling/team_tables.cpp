#include "labelling/team_tables.hpp"

#include <algorithm>
#include <map>
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

template <std::size_t count>
std::uint64_t compare(const std::int32_t* mine, const std::int32_t* theirs) {
    std::uint64_t equal = 0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j)
            equal |= std::uint64_t{mine[i] == theirs[j] && mine[i] >= 0} << (i * kMaxArguments + j);
    return equal;
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

Distance nearest(std::span<const FactId> facts, const std::vector<Distance>& distance) {
    Distance least = kNoWay;
    for (const auto fact : facts) least = std::min(least, distance[fact]);
    return least;
}

std::uint64_t mask_of(std::span<const FactId> facts) {
    std::uint64_t mask = 0;
    for (const auto fact : facts) mask |= std::uint64_t{1} << (mix(static_cast<std::uint64_t>(fact)) & 63);
    return mask;
}

}  // namespace

// Distances in both models, over the facts of the composite task.
class Measure {
public:
    Measure(const Task& composite, const Task& mental, std::vector<FactId> mental_fact,
            std::vector<std::uint8_t> own_human, std::vector<std::uint8_t> mental_human)
        : composite(composite),
          own_graph_(composite),
          mental_(mental),
          mental_graph_(mental),
          mental_fact_(std::move(mental_fact)),
          own_human_(std::move(own_human)),
          mental_human_(std::move(mental_human)) {}

    using Both = std::array<std::vector<Distance>, 2>;  // by Model
    Both to_request(FactId fact) const {
        return both(explicable::to_request(mental_, mental_graph_, mental_fact_[fact], mental_human_),
                    explicable::to_request(composite, own_graph_, fact, own_human_));
    }
    Both to_goal(FactId fact) const {
        return both(explicable::to_goal(mental_, mental_graph_, mental_fact_[fact]),
                    explicable::to_goal(composite, own_graph_, fact));
    }

    const Task& composite;

private:
    Both both(const std::vector<Distance>& mental, std::vector<Distance>&& own) const {
        std::vector<Distance> translated(mental_fact_.size(), kNoWay);
        for (std::size_t fact = 0; fact < mental_fact_.size(); ++fact)
            if (mental_fact_[fact] >= 0) translated[fact] = mental[mental_fact_[fact]];
        return {std::move(translated), std::move(own)};
    }

    TransitionGraph own_graph_;
    const Task& mental_;
    TransitionGraph mental_graph_;
    std::vector<FactId> mental_fact_;
    std::vector<std::uint8_t> own_human_, mental_human_;
};

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
        max_arity = std::max(max_arity, composite.operator_arguments[op].size());
    }
    schema = composite.operator_schema;
    deletes_ = composite.deletes;
    is_human = human_operators(composite, human_objects);
    if (max_arity > compared_) compared_ = kMaxArguments;
    arguments_.assign(static_cast<std::size_t>(num_operators) * compared_, -1);

    const MentalIndex mental_operators(mental.operator_schema, mental.operator_arguments);
    std::vector<std::int32_t> translated;
    for (OperatorId op = 0; op < num_operators; ++op) {
        const auto objects = composite.operator_arguments[op];
        std::ranges::copy(objects.first(std::min(objects.size(), compared_)),
                          arguments_.begin() + static_cast<std::ptrdiff_t>(op) * static_cast<std::ptrdiff_t>(compared_));
        const auto head = schema[op] < 0 ? -1 : names.schema[schema[op]];
        in_mental.push_back(head >= 0 && translate(objects, names.object, translated) &&
                            mental_operators.find(head, translated) >= 0);
        adds_.push_back(all_adds(composite, op));
        adds_mask_.push_back(mask_of(adds_[op]));
        deletes_mask_.push_back(mask_of(deletes_[op]));
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
    const Measure measure(composite, mental, std::move(mental_fact), is_human, human_operators(mental, mental_objects));
    measure_requests(measure);
    measure_goals(measure);
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
    for (std::size_t goal = 0; goal < goals.size(); ++goal)
        goal_of_fact[goals[goal]] = static_cast<std::int32_t>(goal);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        achieved.clear();
        for (const auto fact : all_adds(task, op))
            if (goal_of_fact[fact] >= 0) achieved.push_back(goal_of_fact[fact]);
        achieves.push_back(achieved);
    }
}

void TeamTables::measure_requests(const Measure& measure) {
    const auto width = request_facts.size();
    const auto num_operators = schema.size();
    if (width > 0 && num_operators > kMaxEntries / width) throw std::length_error("too many operators times requests");
    toward_request_.resize(width * num_operators);
    std::vector<std::vector<FactId>> sources;
    for (OperatorId op = 0; op < this->num_operators(); ++op) sources.push_back(used_up(measure.composite, op));
    for (std::size_t request = 0; request < width; ++request) {
        const auto distance = measure.to_request(request_facts[request]);
        for (OperatorId op = 0; op < this->num_operators(); ++op) {
            std::array<Progress, 2> progress;
            for (std::size_t model = 0; model < 2; ++model)
                progress[model] = judge(nearest(sources[op], distance[model]), nearest(adds_[op], distance[model]));
            if (std::ranges::find(fulfils[op], static_cast<std::int32_t>(request)) != fulfils[op].end())
                progress = {Progress::kDone, Progress::kDone};
            toward_request_[static_cast<std::size_t>(op) * width + request] = static_cast<std::uint8_t>(
                static_cast<int>(progress[0]) * kNumProgress + static_cast<int>(progress[1]));
        }
    }
}

void TeamTables::measure_goals(const Measure& measure) {
    const auto count = goals.size(), width = (count + kLanes - 1) / kLanes * kLanes;
    width_ = width;
    const auto num_facts = static_cast<std::size_t>(measure.composite.num_facts());
    if (width > 0 && num_facts > kMaxEntries / (2 * width)) throw std::length_error("too many facts times goals");
    std::vector<Distance> all(2 * width * num_facts, kNoWay);  // fact x model x goal
    std::vector<bool> leads_somewhere(num_facts);
    for (std::size_t goal = 0; goal < count; ++goal) {
        const auto distance = measure.to_goal(goals[goal]);
        for (std::size_t fact = 0; fact < num_facts; ++fact) {
            for (std::size_t model = 0; model < 2; ++model) {
                all[(2 * fact + model) * width + goal] = distance[model][fact];
                if (distance[model][fact] != kNoWay) leads_somewhere[fact] = true;
            }
        }
    }
    find_tours(measure.composite, all);

    std::int32_t num_places = 0;
    const auto add_place = [&](std::span<const FactId> facts) {
        const auto start = distances_.size();
        if (start + 2 * width > kMaxEntries) throw std::length_error("too many places times goals");
        distances_.resize(start + 2 * width, kNoWay);
        for (const auto fact : facts)
            for (std::size_t i = 0; i < 2 * width; ++i)
                distances_[start + i] = std::min(distances_[start + i], all[2 * fact * width + i]);
        return num_places++;
    };
    std::vector<std::int32_t> of_fact(num_facts, -1);
    std::map<std::vector<FactId>, std::int32_t> of_facts;
    const auto place_of = [&](std::vector<FactId> facts) {
        std::erase_if(facts, [&](FactId fact) { return !leads_somewhere[fact]; });
        if (facts.size() == 1) {
            auto& place = of_fact[facts[0]];
            return place >= 0 ? place : place = add_place(facts);
        }
        const auto [place, is_new] = of_facts.try_emplace(std::move(facts), num_places);
        if (is_new) add_place(place->first);
        return place->second;
    };
    for (OperatorId op = 0; op < num_operators(); ++op) {
        from_.push_back(place_of(used_up(measure.composite, op)));
        to_.push_back(place_of({adds_[op].begin(), adds_[op].end()}));
    }
}

// tours_[open][first] = steps that the other open goals take after `first`, one after another in the best order. A
// goal that does not depend on where the one before leaves off adds nothing.
void TeamTables::find_tours(const Task& task, const std::vector<Distance>& distances) {
    const auto count = goals.size();
    if (count > kMaxTourGoals) return;
    std::vector<int> between(count * count, kNoWay);
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        if (achieves[op].empty()) continue;
        std::vector<FactId> after(adds_[op].begin(), adds_[op].end());
        std::ranges::set_difference(task.preconditions[op], task.deletes[op], std::back_inserter(after));
        for (const auto goal : achieves[op])
            for (std::size_t other = 0; other < count; ++other)
                for (const auto fact : after) {
                    auto& steps = between[goal * count + other];
                    steps = std::min<int>(steps, distances[2 * static_cast<std::size_t>(fact) * width_ + other]);
                }
    }
    std::ranges::replace(between, static_cast<int>(kNoWay), 0);
    tours_.assign(width_ << count, 0);
    for (std::size_t open = 1; open < std::size_t{1} << count; ++open) {
        for (std::size_t first = 0; first < count; ++first) {
            const std::size_t others = open & ~(std::size_t{1} << first);
            if (others == open || others == 0) continue;
            int best = kNoWay - 1;
            for (std::size_t next = 0; next < count; ++next)
                if (others >> next & 1)
                    best = std::min(best, between[first * count + next] + tours_[others * width_ + next]);
            tours_[open * width_ + first] = static_cast<Distance>(best);
        }
    }
}

GoalProgress TeamTables::toward_goals(OperatorId step, const OpenGoals& open) const {
    if (open.num_open() == 0) return {Progress::kNoTarget, Progress::kNoTarget, Progress::kNoTarget};
    for (const auto goal : achieves[step])
        if (open.is_open(goal)) return {Progress::kDone, Progress::kDone, Progress::kDone};
    const Distance* const closed = open.closed();
    const auto nearest = [closed, width = width_](const Distance* distance) {
        Distance least = kNoWay;
        for (std::size_t goal = 0; goal < width; goal += kLanes)
            for (std::size_t lane = goal; lane < goal + kLanes; ++lane)
                least = std::min(least, static_cast<Distance>(distance[lane] | closed[lane]));
        return least;
    };
    const auto* const from = row(from_[step], Model::kMental);
    const auto* const to = row(to_[step], Model::kMental);
    GoalProgress progress{};
    progress.mental = judge(nearest(from), nearest(to));
    progress.own = judge(nearest(from + width_), nearest(to + width_));
    if (goals.size() > kMaxTourGoals) {
        progress.mission = progress.mental;
        return progress;
    }
    const Distance* const tours = tours_.data() + open.bits() * width_;
    const auto finish = [closed, tours, width = width_](const Distance* distance) {
        int least = kNoWay;
        for (std::size_t goal = 0; goal < width; goal += kLanes)
            for (std::size_t lane = goal; lane < goal + kLanes; ++lane) {
                const int here = distance[lane] | closed[lane];
                least = std::min(least, here == kNoWay ? kNoWay : std::min(here + tours[lane], kNoWay - 1));
            }
        return static_cast<Distance>(least);
    };
    progress.mission = judge(finish(from), finish(to));
    return progress;
}

bool TeamTables::takes_back(OperatorId step, OperatorId earlier) const {
    return earlier >= 0 && adds_mask_[step] != 0 && (adds_mask_[step] & ~deletes_mask_[earlier]) == 0 &&
           std::ranges::includes(deletes_[earlier], adds_[step]);
}

std::uint64_t TeamTables::equal_arguments(OperatorId step, OperatorId other) const {
    const auto* const mine = arguments_.data() + static_cast<std::size_t>(step) * compared_;
    const auto* const theirs = arguments_.data() + static_cast<std::size_t>(other) * compared_;
    return compared_ == 4 ? compare<4>(mine, theirs) : compare<kMaxArguments>(mine, theirs);
}

}  // namespace explicable
