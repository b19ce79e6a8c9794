// What a search asks of a scorer most often, with a memory for what steps have scored and with odds in the place of their logarithms:
// most steps of most relaxed plans take a look-up and a few products.
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

// Random odd numbers: the upper bits of sums of products with such are well mixed (Dietzfelbinger 1996).
constexpr std::uint64_t kOfSteps = 0x9E3779B97F4A7C15u, kOfGoals = 0xD1B54A32D192ED03u, kOfMind = 0x8CB92BA72F3D8DD7u;
constexpr double kMostScore = 150;  // a product of four odds within this neither overflows a tally nor vanishes

std::uint64_t both(std::int32_t a, std::int32_t b) {
    return std::uint64_t{static_cast<std::uint32_t>(a)} << 32 | static_cast<std::uint32_t>(b);
}

// The robots' last steps, with what they have deleted at hand.
class RecentSteps {
public:
    RecentSteps(const TeamTables& tables, const Situation& situation) {
        for (auto step = situation.robot_steps.rbegin(); step != situation.robot_steps.rend(); ++step)
            add(*step, tables.marks(*step));
    }
    void add(OperatorId step, const StepMarks& marks) {
        steps_[count_ % kRecentSteps] = step;
        deletes_[count_ % kRecentSteps] = marks.deletes;
        ++count_;
    }
    bool may_be_taken_back(const StepMarks& marks) const {
        bool may = false;
        for (const auto deletes : deletes_) may |= (marks.adds & ~deletes) == 0;
        return may;
    }
    // The latest first.
    std::array<OperatorId, kRecentSteps> steps() const {
        std::array<OperatorId, kRecentSteps> steps;
        for (std::size_t i = 0; i < kRecentSteps; ++i) steps[i] = steps_[(count_ - 1 - i) % kRecentSteps];
        return steps;
    }

private:
    std::array<OperatorId, kRecentSteps> steps_;
    std::array<std::uint32_t, kRecentSteps> deletes_;
    std::size_t count_ = 0;
};

}  // namespace

class Scorer::RememberingCounter : public Counter {
public:
    explicit RememberingCounter(const Scorer& scorer)
        : scorer_(scorer), tables_(*scorer.tables_), memory_(scorer.memories_->lend()) {}
    ~RememberingCounter() override { scorer_.memories_->take_back(std::move(memory_)); }
    RememberingCounter(const RememberingCounter&) = delete;

    double count(const std::byte* node, const State& state, std::span<const OperatorId> relaxed_plan) override {
        const Context context = read(node);
        if (context.num_steps == 0 && relaxed_plan.empty()) return 0;
        list_questions(context.situation, state, relaxed_plan);
        find_odds(context);
        if (are_odds_too_large_) return scorer_.score(node, state, relaxed_plan).num_inexplicable;
        auto tally = tally_of<1>(context.chain);
        for (const double odds : odds_) tally.append_odds(scorer_.factors_, odds);
        return tally.mean();
    }

private:
    // What are the odds that a step, or -1 for the end, leaves to the one before it and has itself of being inexplicable?
    struct Question {
        std::uint64_t key;   // all that the answer hangs on, but for steps taken back
        std::uint64_t open;  // goals: a bit for each
        double taking_back;  // score
        OperatorId step;
        bool changes_requests;
    };

    void list_questions(Situation situation, const State& state, std::span<const OperatorId> relaxed_plan) {
        for (const auto step : relaxed_plan) prefetch_line(&tables_.marks(step));
        questions_.resize(relaxed_plan.size() + 1);
        auto question = questions_.begin();
        RecentSteps recent(tables_, situation);
        auto open = tables_.open_goals(state).bits();
        auto mind = mind_of(situation);
        // How a step is seen by the next hangs on the mind in which it is taken. Since the last step of the path requests may have
        // been withdrawn.
        auto mind_before = both(situation.neighbour, -2) * kOfMind;  // -2: no human's step
        for (const auto step : relaxed_plan) {
            if (tables_.is_auxiliary(step)) continue;
            const StepMarks& marks = tables_.marks(step);
            const bool may_fulfil = marks.fulfils && situation.num_open > 0;
            const auto mind_here = may_fulfil && scorer_.fulfils_open(situation, step) ? ~mind : mind;
            const auto concerned = (open & marks.concerned) | std::uint64_t{open == 0} << StepMarks::kMaxGoals;
            const auto key = both(step, situation.last) * kOfSteps + concerned * kOfGoals + (mind_here ^ std::rotl(mind_before, 32));
            memory_->prefetch(key);
            *question = {key, open, 0, step, marks.is_human || may_fulfil};
            if (recent.may_be_taken_back(marks)) {
                situation.robot_steps = recent.steps();
                question->taking_back = scorer_.taking_back(situation, step);
            }
            open &= ~marks.achieves;
            mind_before = mind_here;
            situation.last = step;
            if (!marks.is_human) recent.add(step, marks);
            if (question++->changes_requests) {
                scorer_.remember_requests(situation, step);
                mind = mind_of(situation);
            }
        }
        const auto key = both(-1, situation.last) * kOfSteps + std::rotl(mind_before, 32);
        memory_->prefetch(key);
        *question++ = {key, 0, 0, -1, false};
        questions_.erase(question, questions_.end());
    }

    // Of all steps whose labels are not in the context's chain.
    void find_odds(const Context& context) {
        odds_.clear();
        are_odds_too_large_ = false;
        Situation situation = context.situation;
        auto up_to_date = questions_.begin();  // the requests of the situation, before this step
        double pending = odds_of(context.pending);
        for (auto question = questions_.begin(); question != questions_.end(); ++question) {
            auto& place = (*memory_)[question->key];
            if (place.key != question->key) {
                for (; up_to_date != question; ++up_to_date)
                    if (up_to_date->changes_requests) scorer_.remember_requests(situation, up_to_date->step);
                const auto score = scorer_.judge(situation, question->step, OpenGoals(tables_.goals.size(), question->open));
                const double odds_of_last = odds_of(score.of_last), odds_of_step = odds_of(score.of_step);
                if (are_odds_too_large_) return;  // not remembered, lest the answer hang on what has been asked before
                place = {question->key, odds_of_last, odds_of_step, score.neighbour};
            }
            if (situation.last >= 0) odds_.push_back(pending * place.odds_of_last);
            pending = place.odds_of_step;
            if (question->taking_back != 0) pending *= odds_of(question->taking_back);
            situation.last = question->step;
            situation.neighbour = place.neighbour;
        }
    }
    double odds_of(double score) {
        are_odds_too_large_ |= std::abs(score) > kMostScore && score != kExplicable;
        return std::exp(score);
    }
    // What the person has in mind, as far as scores hang on it.
    std::uint64_t mind_of(const Situation& situation) const {
        return both(situation.request(), scorer_.uses_human_ ? situation.last_human : -1) * kOfMind;
    }

    const Scorer& scorer_;
    const TeamTables& tables_;
    std::unique_ptr<StepMemory> memory_;
    std::vector<Question> questions_;
    std::vector<double> odds_;
    bool are_odds_too_large_ = false;
};

std::unique_ptr<Counter> Scorer::counter() const {
    const bool can_remember = expected_ && tables_->goals.size() <= StepMarks::kMaxGoals;
    return can_remember ? std::make_unique<RememberingCounter>(*this) : PathScorer::counter();
}

}  // namespace explicable
