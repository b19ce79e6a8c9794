#include "search/tour.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <set>

namespace explicable {

namespace {

bool contains(std::span<const FactId> facts, FactId fact) {
    return std::find(facts.begin(), facts.end(), fact) != facts.end();
}

}  // namespace

Moves::Moves(const Task& task, VariableId variable) : variable_(variable), operators_(task.num_operators(), 0) {
    std::vector<std::vector<Move>> to(task.variable_facts[variable].size() + 1);
    for (OperatorId id = 0; id < task.num_operators(); ++id) {
        Move move{-1, id};
        for (const FactId fact : task.preconditions[id]) {
            if (task.fact_variable[fact] == variable) move.from = task.fact_value[fact];
        }
        bool lands = false, leaves = false;
        const auto land = [&](std::span<const FactId> facts) {
            for (const FactId fact : facts) {
                if (task.fact_variable[fact] != variable) continue;
                lands = true;
                to[task.fact_value[fact]].push_back(move);
            }
        };
        const auto leave = [&](std::span<const FactId> facts) {
            leaves = leaves || std::any_of(facts.begin(), facts.end(), [&](FactId fact) { return task.fact_variable[fact] == variable; });
        };
        land(task.adds[id]);
        leave(task.deletes[id]);
        const bool lands_for_certain = lands;
        for (auto effect = task.effect_offsets[id]; effect < task.effect_offsets[id + 1]; ++effect) {
            land(task.effect_adds[effect]);
            leave(task.effect_deletes[effect]);
        }
        operators_[id] = lands || leaves;
        if (operators_[id] && !lands_for_certain) to[0].push_back(move);
    }
    for (const auto& moves : to) to_.push_back(moves);
}

Tour::Tour(const Question& question, const std::vector<char>& possible, KnownMoves& moves)
    : task_(question.task), achievers_(question.prepared.achievers()), possible_(&possible) {
    choose_mover(question);
    if (mover_ != none) {
        measure_distances(moves.of(task_, mover_));
        plan_tours();
        list_parts(question.goal);
        list_losses();
    }
    possible_ = nullptr;
    is_charged_ = {};
}

std::vector<OperatorId> Tour::achievers_of(FactId fact) const {
    std::vector<OperatorId> found;
    for (const OperatorId id : achievers_[fact]) {
        if ((*possible_)[id] && (found.empty() || found.back() != id)) found.push_back(id);
    }
    return found;
}

std::int32_t Tour::place_needed(FactId goal, VariableId variable) const {
    if (task_.fact_variable[goal] == variable) return task_.fact_value[goal];
    std::int32_t place = 0;
    for (const OperatorId id : achievers_of(goal)) {
        std::int32_t needed = 0;
        for (const FactId fact : task_.preconditions[id]) {
            if (task_.fact_variable[fact] == variable) needed = task_.fact_value[fact];
        }
        if (needed == 0 || (place != 0 && needed != place)) return 0;
        place = needed;
    }
    return place;
}

// The variable that has to be in most places.
void Tour::choose_mover(const Question& question) {
    std::set<VariableId> candidates;
    std::vector<FactId> lacking;
    for (const FactId goal : question.goal) {
        if (question.initial.holds(task_, goal)) continue;
        lacking.push_back(goal);
        candidates.insert(task_.fact_variable[goal]);
        const auto achievers = achievers_of(goal);
        if (achievers.empty()) continue;
        for (const FactId fact : task_.preconditions[achievers.front()]) candidates.insert(task_.fact_variable[fact]);
    }
    for (const VariableId variable : candidates) {
        std::vector<std::int32_t> places;
        for (const FactId goal : lacking) {
            const std::int32_t place = place_needed(goal, variable);
            if (place != 0 && std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
        }
        if (places.size() > most_stops) places.resize(most_stops);
        if (places.size() > stops_.size()) {
            mover_ = variable;
            stops_ = std::move(places);
        }
    }
}

// Backwards from each stop, by Dijkstra's algorithm. Operators that move the mover are charged for here.
void Tour::measure_distances(const Moves& moves) {
    const std::int32_t num_values = static_cast<std::int32_t>(task_.variable_facts[mover_].size()) + 1;
    is_charged_ = moves.operators();
    using Entry = std::pair<double, std::int32_t>;
    for (const std::int32_t stop : stops_) {
        auto& distance = distance_.emplace_back(num_values, dead_end);
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        distance[stop] = 0.0;
        queue.push({0.0, stop});
        while (!queue.empty()) {
            const auto [reached, value] = queue.top();
            queue.pop();
            if (reached > distance[value]) continue;
            const auto come_from = [&](std::int32_t from, double sum) {
                if (sum >= distance[from]) return;
                distance[from] = sum;
                queue.push({sum, from});
            };
            for (const auto& move : moves.to(value)) {
                if (!(*possible_)[move.by]) continue;
                const double sum = reached + std::max(0, task_.cost[move.by]);
                if (move.from >= 0) come_from(move.from, sum);
                else for (std::int32_t from = 0; from < num_values; ++from) come_from(from, sum);
            }
        }
    }
}

// Held & Karp: a tour that begins at one stop of a set is that one, and a tour of the others.
void Tour::plan_tours() {
    const std::size_t num_stops = stops_.size();
    tour_.assign((std::size_t{1} << num_stops) * num_stops, dead_end);
    for (std::size_t set = 1; set < std::size_t{1} << num_stops; ++set) {
        for (std::size_t first = 0; first < num_stops; ++first) {
            const std::size_t rest = set & ~(std::size_t{1} << first);
            if (rest == set) continue;
            double best = rest ? dead_end : 0.0;
            for (std::size_t next = 0; next < num_stops; ++next) {
                if (rest >> next & 1) {
                    best = std::min(best, distance_[next][stops_[first]] + tour_[rest * num_stops + next]);
                }
            }
            tour_[set * num_stops + first] = best;
        }
    }
}

// What lacks and is needed in any case, as long as no operator is charged for two of them.
void Tour::list_parts(const std::vector<FactId>& goals) {
    for (const FactId goal : goals) {
        Part part{goal, {}, -1};
        const auto stop = std::find(stops_.begin(), stops_.end(), place_needed(goal, mover_));
        if (stop != stops_.end()) part.stop = static_cast<int>(stop - stops_.begin());
        const auto achievers = achievers_of(goal);
        charge(goal, part.needs);
        if (!achievers.empty()) {
            for (const FactId fact : task_.preconditions[achievers.front()]) {
                const bool by_all = std::all_of(achievers.begin(), achievers.end(), [&](OperatorId id) {
                    return contains(task_.preconditions[id], fact);
                });
                if (by_all && task_.fact_variable[fact] != mover_) charge(fact, part.needs);
            }
        }
        parts_.push_back(std::move(part));
    }
}

bool Tour::charge(FactId fact, std::vector<Need>& needs) {
    const auto achievers = achievers_of(fact);
    double cheapest = dead_end;
    for (const OperatorId id : achievers) {
        if (is_charged_[id]) return false;
        cheapest = std::min(cheapest, static_cast<double>(std::max(0, task_.cost[id])));
    }
    for (const OperatorId id : achievers) is_charged_[id] = 1;
    needs.push_back({fact, cheapest});
    return true;
}

// The goals of the tour are achieved one after another, and what the first of them needs before the others. Where each operator that
// adds that takes away what another goal needs, this is to be added again, which is charged for nowhere else.
void Tour::list_losses() {
    losses_.resize(stops_.size());
    for (std::size_t stop = 0; stop < stops_.size(); ++stop) {
        const auto serves = [stop](const Part& part) { return part.stop == static_cast<int>(stop); };
        const auto first = std::find_if(parts_.begin(), parts_.end(), serves);
        if (std::count_if(parts_.begin(), parts_.end(), serves) != 1) continue;  // either of them may come first
        for (const Part& part : parts_) {
            if (part.stop < 0 || serves(part)) continue;
            for (const Need& need : part.needs) {
                const FactId cause = need.fact == part.goal ? -1 : cause_of_loss(*first, need.fact);
                if (cause >= 0) losses_[stop].push_back({part.goal, need.fact, cause, need.cost});
            }
        }
        is_tighter_ = is_tighter_ || !losses_[stop].empty();
    }
}

FactId Tour::cause_of_loss(const Part& first, FactId fact) const {
    for (const Need& need : first.needs) {
        if (need.fact == first.goal) continue;
        const auto achievers = achievers_of(need.fact);
        const bool is_lost = std::all_of(achievers.begin(), achievers.end(), [&](OperatorId id) {
            return contains(task_.deletes[id], fact) && !contains(task_.adds[id], fact) && contains(task_.adds[id], need.fact);
        });
        if (is_lost) return need.fact;
    }
    return -1;
}

double Tour::cost(const State& state) const {
    return cost([&](FactId fact) { return state.holds(task_, fact); }, state.values[mover_], false);
}

double Tour::cost(const StatePacker& packer, const Word* state) const {
    return cost([&](FactId fact) { return packer.holds(state, fact); }, packer.get(state, mover_), false);
}

double Tour::bound(const StatePacker& packer, const Word* state) const {
    return cost([&](FactId fact) { return packer.holds(state, fact); }, packer.get(state, mover_), is_tighter_);
}

template <class Holds>
double Tour::cost(const Holds& holds, std::int32_t place, bool with_losses) const {
    double sum = 0.0;
    std::size_t left = 0;
    for (const Part& part : parts_) {
        if (holds(part.goal)) continue;
        if (part.stop >= 0) left |= std::size_t{1} << part.stop;
        for (const Need& need : part.needs) {
            if (!holds(need.fact)) sum += need.cost;
        }
    }
    if (left == 0) return sum;
    const std::size_t num_stops = stops_.size();
    double best = dead_end;
    for (std::size_t first = 0; first < num_stops; ++first) {
        if (!(left >> first & 1)) continue;
        double way = distance_[first][place] + tour_[left * num_stops + first];
        if (with_losses) {
            for (const Loss& loss : losses_[first]) {
                if (!holds(loss.goal) && holds(loss.fact) && !holds(loss.cause)) way += loss.cost;
            }
        }
        best = std::min(best, way);
    }
    return sum + best;
}

std::size_t Tour::memory_bytes() const {
    std::size_t bytes = sizeof(*this) + tour_.capacity() * sizeof(double) + parts_.capacity() * sizeof(Part);
    for (const auto& row : distance_) bytes += row.capacity() * sizeof(double);
    for (const Part& part : parts_) bytes += part.needs.capacity() * sizeof(Need);
    for (const auto& row : losses_) bytes += row.capacity() * sizeof(Loss);
    return bytes;
}

}  // namespace explicable
