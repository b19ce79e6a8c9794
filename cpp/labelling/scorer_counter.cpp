// What a search asks of a scorer most often, with a memory for what steps have scored and with odds in the place of their logarithms:
// most steps of most relaxed plans take two look-ups and a few products.
#include <algorithm>
#include <cmath>
#include <utility>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

// Random odd numbers: the upper bits of sums of products with such are well mixed (Dietzfelbinger 1996).
constexpr std::uint64_t kOfSteps = 0x9E3779B97F4A7C15u, kOfGoals = 0xD1B54A32D192ED03u, kOfMind = 0x8CB92BA72F3D8DD7u,
                        kOfFulfilling = 0xA24BAED4963EE407u;
constexpr std::size_t kAhead = 4;  // steps, so that memory answers in time
constexpr double kMostScore = 100;  // of a step by itself: with the pairs it is in, odds neither overflow a tally nor vanish

std::uint64_t both(std::int32_t a, std::int32_t b) {
    return std::uint64_t{static_cast<std::uint32_t>(a)} << 32 | static_cast<std::uint32_t>(b);
}

// The robots' last steps, with what they have deleted at hand.
class RecentSteps {
public:
    RecentSteps(const TeamTables& tables, const RobotSteps& steps) {
        for (auto step = steps.rbegin(); step != steps.rend(); ++step) add(*step, tables.marks(*step));
    }
    void add(OperatorId step, const StepMarks& marks) {
        steps_[count_++ % kRecentSteps] = step;
        for (std::size_t i = kRecentSteps - 1; i > 0; --i) deletes_[i] = deletes_[i - 1] | marks.deletes;
        deletes_[0] = marks.deletes;
    }
    // False only if the step surely takes none of them back.
    bool may_be_taken_back(const StepMarks& marks) const { return (marks.adds & ~deletes_.back()) == 0; }
    // The latest first.
    RobotSteps steps() const {
        RobotSteps steps;
        for (std::size_t i = 0; i < kRecentSteps; ++i) steps[i] = steps_[(count_ - 1 - i) % kRecentSteps];
        return steps;
    }

private:
    RobotSteps steps_;
    std::array<std::uint32_t, kRecentSteps> deletes_{};  // of the last one, two, ...
    std::size_t count_ = 0;
};

}  // namespace

class Scorer::RememberingCounter : public Counter, public ChildCounter {
public:
    explicit RememberingCounter(const Scorer& scorer)
        : scorer_(scorer), tables_(*scorer.tables_), memory_(scorer.memories_->lend()) {}
    ~RememberingCounter() override { scorer_.memories_->take_back(std::move(memory_)); }
    RememberingCounter(const RememberingCounter&) = delete;

    double count(const std::byte* context, const State& state, std::span<const OperatorId> relaxed_plan) override {
        start(context, state);
        return count(-1, state, relaxed_plan);
    }
    ChildCounter* of_children() override { return this; }

    void start(const std::byte* context, const State& state) override {
        start_ = read(context);
        open_ = tables_.open_goals(state);
        is_too_large_ = false;
        pending_ = odds_of(start_.pending);
        is_start_too_large_ = is_too_large_;
    }
    double count(OperatorId step, const State& state, std::span<const OperatorId> relaxed_plan) override {
        prefetch(step, relaxed_plan);
        is_too_large_ = is_start_too_large_;
        Situation situation = start_.situation;
        Walk walk(*this, situation);
        if (step >= 0 && !tables_.is_auxiliary(step)) {
            walk.take(step);
            scorer_.withdraw_requests(situation, state);
            walk.look_at_requests();
        }
        walk.open = tables_.open_goals(state).bits();
        for (std::size_t i = 0; i < relaxed_plan.size(); ++i) {
            if (i + kAhead < relaxed_plan.size()) walk.prefetch(relaxed_plan[i + kAhead]);
            if (!tables_.is_auxiliary(relaxed_plan[i])) walk.take(relaxed_plan[i]);
        }
        if (walk.last < 0) return 0;
        walk.stand_side_by_side(-1, kNothing);
        return is_too_large_ ? scorer_.count_after(start_, step, open_, state, relaxed_plan) : walk.tally.mean();
    }

private:
    // How far labels are counted. Inlined, so that it stays in registers.
    struct Walk {
        Walk(RememberingCounter& counter, Situation& situation)
            : counter(counter),
              scorer(counter.scorer_),
              memory(*counter.memory_),
              situation(situation),
              recent(counter.tables_, situation.robot_steps),
              open(counter.open_.bits()),
              last(situation.last),
              neighbour(situation.neighbour),
              pending(counter.pending_),
              tally(tally_of<1>(counter.start_.chain)) {
            look_at_requests();
        }

        [[gnu::always_inline]] void take(OperatorId step) {
            const StepMarks& marks = counter.tables_.marks(step);
            bool changes_requests = marks.is_human;
            if (marks.is_human) {
                stand_side_by_side(step, kHumanStep);
                pending = 0;
            } else {
                changes_requests = (marks.fulfils & requests) != 0 && scorer.fulfils_open(situation, step);
                const auto key = key_of(step, marks, mind + kOfFulfilling * changes_requests);
                auto& own = memory.own(key);
                if (!own.is_of(key)) [[unlikely]] counter.find(situation, step, open, key, own);
                const double odds = own.odds;
                stand_side_by_side(step, own.neighbour());
                pending *= odds;
                if (recent.may_be_taken_back(marks)) [[unlikely]] pending *= counter.odds_of_taking_back(recent.steps(), step);
                recent.add(step, marks);
            }
            open &= ~marks.achieves;
            if (changes_requests) {
                scorer.remember_requests(situation, step);
                look_at_requests();
            }
        }
        void look_at_requests() {
            mind = counter.mind_of(situation);
            requests = 0;
            for (const auto request : situation.requests()) requests |= StepMarks::bit_of(request);
        }
        // Most steps change neither what is open nor what anybody has in mind.
        [[gnu::always_inline]] void prefetch(OperatorId step) const {
            prefetch_line(&memory.own(key_of(step, counter.tables_.marks(step), mind)));
        }
        [[gnu::always_inline]] std::uint64_t key_of(OperatorId step, const StepMarks& marks, std::uint64_t mind_here) const {
            const auto concerned = (open & marks.concerned) | std::uint64_t{open == 0} << StepMarks::kMaxGoals;
            return static_cast<std::uint64_t>(step) * kOfSteps + concerned * kOfGoals + mind_here;
        }
        // Makes the label of the last step final.
        [[gnu::always_inline]] void stand_side_by_side(OperatorId step, int seen_as) {
            const auto key = StepMemory::pair_key(last, step);
            auto& pair = memory.pair(key);
            if (pair.key != key) [[unlikely]] counter.find(last, step, key, pair);
            const Pair& beside = scorer.odds_beside_[place_of(seen_as, neighbour)];
            if (last >= 0) tally.append_odds(scorer.factors_, pending * pair.odds_of_last * beside.of_last);
            pending = pair.odds_of_step * beside.of_step;
            last = step;
            neighbour = seen_as;
        }

        RememberingCounter& counter;
        const Scorer& scorer;
        StepMemory& memory;
        Situation& situation;  // requests and the last human step
        RecentSteps recent;
        std::uint64_t open;  // goals: a bit for each
        std::uint64_t mind;      // what the person has in mind, as far as scores hang on it
        std::uint32_t requests;  // open ones: some bit for each
        OperatorId last;
        int neighbour;   // the last as the next step sees it
        double pending;  // odds of the last step, but for its look-ahead
        Tally<1> tally;  // of all steps but the last
    };

    void prefetch(OperatorId last, std::span<const OperatorId> relaxed_plan) {
        for (const auto step : relaxed_plan) {
            prefetch_line(&tables_.marks(step));
            prefetch_line(&memory_->pair(StepMemory::pair_key(last, step)));
            last = step;
        }
    }
    // Not remembered if too large, lest the answer hang on what has been asked before.
    [[gnu::noinline]] void find(const Situation& situation, OperatorId step, std::uint64_t open, std::uint64_t key,
                                StepMemory::Own& place) {
        int neighbour = kNothing;
        const double odds = odds_of(scorer_.own_score(situation, step, OpenGoals(tables_.goals.size(), open), neighbour));
        place = {is_too_large_ ? 0 : key, odds, neighbour};
    }
    [[gnu::noinline]] void find(OperatorId last, OperatorId step, std::uint64_t key, StepMemory::Pair& place) {
        const TeamStep& before = tables_[last];
        const TeamStep& after = tables_[step];
        Pair odds = scorer_.odds_of_schemas_[scorer_.place_of_schemas(after, before)];
        scorer_.odds_of_same_.for_equal(after, before, [&odds](const Pair& of_equal) { odds *= of_equal; });
        place = {key, odds.of_step, odds.of_last};
    }
    [[gnu::noinline]] double odds_of_taking_back(const RobotSteps& recent, OperatorId step) {
        const double score = scorer_.taking_back(recent, step);
        return score == 0 ? 1 : odds_of(score);
    }
    double odds_of(double score) {
        is_too_large_ |= std::abs(score) > kMostScore && score != kExplicable;
        return std::exp(score);
    }
    std::uint64_t mind_of(const Situation& situation) const {
        return both(situation.request(), scorer_.uses_human_ ? situation.last_human : -1) * kOfMind;
    }

    const Scorer& scorer_;
    const TeamTables& tables_;
    std::unique_ptr<StepMemory> memory_;
    Context start_;
    OpenGoals open_{0};  // goals at the start
    double pending_ = 0;  // odds of the last step at the start, but for its look-ahead
    bool is_start_too_large_ = false, is_too_large_ = false;  // some odds
};

std::unique_ptr<Counter> Scorer::counter() const {
    const bool can_remember = has_odds_ && tables_->goals.size() <= StepMarks::kMaxGoals;
    return can_remember ? std::make_unique<RememberingCounter>(*this) : PathScorer::counter();
}

}  // namespace explicable
