// How steps change the distance to requests and goals: tables made once, and what a step looks up in them.
#include <algorithm>
#include <map>
#include <stdexcept>

#include "labelling/distances.hpp"
#include "labelling/team_tables.hpp"

namespace explicable {
namespace {

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

}  // namespace

void TeamTables::measure_requests(const Measure& measure) {
    const auto width = static_cast<std::size_t>(num_requests());
    const auto num_operators = static_cast<std::size_t>(this->num_operators());
    if (width > 0 && num_operators > kMaxEntries / width) throw std::length_error("too many operators times requests");
    toward_request_.resize(width * num_operators);
    std::vector<std::vector<FactId>> sources;
    for (OperatorId op = 0; op < this->num_operators(); ++op) sources.push_back(used_up(measure.composite, op));
    for (std::size_t request = 0; request < width; ++request) {
        const auto distance = measure.to_request(request_facts[static_cast<std::int32_t>(request)]);
        for (OperatorId op = 0; op < this->num_operators(); ++op) {
            std::array<Progress, 2> progress;
            for (std::size_t model = 0; model < 2; ++model)
                progress[model] = judge(nearest(sources[op], distance[model]), nearest(adds_[op], distance[model]));
            if (std::ranges::find(fulfils[op], static_cast<std::int32_t>(request)) != fulfils[op].end())
                progress = {Progress::kDone, Progress::kDone};
            toward_request_[place_of(op, static_cast<int>(request))] = RequestProgress(progress[0], progress[1]).code;
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
    for (OperatorId op = 0; op < num_operators(); ++op)
        moves_.push_back({place_of(used_up(measure.composite, op)), place_of({adds_[op].begin(), adds_[op].end()}), false});
    const auto models_agree = [&](std::int32_t place) {
        return std::equal(row(place, Model::kMental), row(place, Model::kMental) + width, row(place, Model::kOwn));
    };
    for (auto& move : moves_) move.models_agree = models_agree(move.from) && models_agree(move.to);
    find_concerned();
}

// A step's progress hangs on the goals to which there is a way from where it leads, or led. The best order of all goals hangs
// on all of them.
void TeamTables::find_concerned() {
    if (goals.size() > StepMarks::kMaxGoals) return;
    for (OperatorId op = 0; op < num_operators(); ++op) {
        auto& marks = marks_[op + 1];
        for (const auto place : {moves_[op].from, moves_[op].to})
            for (std::size_t i = 0; i < 2 * width_; ++i)
                if (row(place, Model::kMental)[i] != kNoWay) marks.concerned |= std::uint64_t{1} << i % width_;
        for (const auto goal : achieves[op]) marks.achieves |= std::uint64_t{1} << goal;
        marks.concerned |= marks.achieves;
        if (marks.concerned != 0 && goals.size() <= kMaxTourGoals) marks.concerned = (std::uint64_t{1} << goals.size()) - 1;
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

GoalProgress TeamTables::find_toward_goals(OperatorId step, const OpenGoals& open) const {
    for (const auto goal : achieves[step])
        if (open.is_open(static_cast<std::size_t>(goal))) return {Progress::kDone, Progress::kDone, Progress::kDone};
    const auto nearest = [&open, width = width_](const Distance* distance) {
        Lanes least(kNoWay);
        for (std::size_t goal = 0; goal < width; goal += kLanes) least = least.min(Lanes(distance + goal) | open.closed(goal));
        return least.least();
    };
    const Move& move = moves_[step];
    const auto* const from = row(move.from, Model::kMental);
    const auto* const to = row(move.to, Model::kMental);
    const Progress mental = judge(nearest(from), nearest(to));
    const Progress own = move.models_agree ? mental : judge(nearest(from + width_), nearest(to + width_));
    if (goals.size() > kMaxTourGoals) return {mental, own, mental};
    const Distance* const tours = tours_.data() + open.bits() * width_;
    const auto finish = [&open, tours, width = width_](const Distance* distance) {
        const Lanes no_way(kNoWay), longest(kNoWay - 1);
        Lanes least(no_way);
        for (std::size_t goal = 0; goal < width; goal += kLanes) {
            const Lanes here = Lanes(distance + goal) | open.closed(goal);
            least = least.min(here.plus(Lanes(tours + goal)).min(longest) | here.where_equal(no_way));
        }
        return least.least();
    };
    return {mental, own, judge(finish(from), finish(to))};
}

}  // namespace explicable
