// What the features of a step see of a team task, as flat arrays: who acts, what a human step asks for, and how far
// every step is from every target, in the robot's own model and in the mental model (docs/labelling.md).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "labelling/lanes.hpp"
#include "task/state.hpp"
#include "task/task.hpp"

namespace explicable {

using Distance = std::int16_t;
inline constexpr Distance kNoWay = 0x7FFF;  // all bits set: or'ing it makes any distance infinite
inline constexpr int kMaxTourGoals = 10;  // with more open goals than this no best order is looked for

inline constexpr std::size_t kMaxArguments = 8;  // further arguments are not compared

enum class Model : int { kMental = 0, kOwn = 1 };

// How a step changes the distance to a target; the order is that of `PROGRESS` in features.py.
enum class Progress : std::uint8_t {
    kNoTarget,
    kUnconcerned,
    kNearer,
    kSame,
    kFarther,
    kMuchFarther,
    kNoWay,
    kShortcut,
    kDone,
    kDoneOther,
};
inline constexpr int kNumProgress = 10;

// The composite task's numbering in terms of the mental task's; -1: the mental task has no such thing.
struct MentalNames {
    std::vector<std::int32_t> schema, predicate, object;
};

// Objects in the mental task's numbering; false if it does not have them all.
bool translate_objects(std::span<const std::int32_t> arguments, const std::vector<std::int32_t>& object,
                       std::vector<std::int32_t>& translated);

// The mental task's number of each fact of the composite task, or -1.
std::vector<FactId> find_mental_facts(const Task& composite, const Task& mental, const MentalNames& names);

// The goals that are not fulfilled, a bit for each.
class OpenGoals {
public:
    explicit OpenGoals(std::size_t num_goals) {
        if (num_goals < kWord) {
            first_ = (std::uint64_t{1} << num_goals) - 1;
            return;
        }
        others_.assign(num_goals / kWord, ~std::uint64_t{0});
        others_.back() = (std::uint64_t{1} << num_goals % kWord) - 1;
    }

    // `open`: a bit for each of no more than 64.
    OpenGoals(std::size_t num_goals, std::uint64_t open) : OpenGoals(num_goals) { first_ = open; }

    void close(std::size_t goal) { word(goal) &= ~(std::uint64_t{1} << goal % kWord); }
    bool is_open(std::size_t goal) const { return word(goal) >> goal % kWord & 1; }
    bool none() const {
        return first_ == 0 && std::ranges::all_of(others_, [](std::uint64_t bits) { return bits == 0; });
    }
    std::uint64_t bits() const { return first_; }  // all of them if there are no more than 64
    // Of `goal`, a multiple of kLanes, and those after it: kNoWay for a goal that is fulfilled, 0 for an open one.
    Lanes closed(std::size_t goal) const { return Lanes::where_clear(static_cast<unsigned>(word(goal) >> goal % kWord & 255)); }

private:
    static constexpr std::size_t kWord = 64;
    std::uint64_t& word(std::size_t goal) { return goal < kWord ? first_ : others_[goal / kWord - 1]; }
    std::uint64_t word(std::size_t goal) const { return goal < kWord ? first_ : others_[goal / kWord - 1]; }

    std::uint64_t first_ = ~std::uint64_t{0};
    std::vector<std::uint64_t> others_;
};

// Progress of a robot's step toward the open goals: four bits each.
struct GoalProgress {
    std::uint16_t code = 0;

    GoalProgress(Progress mental, Progress own, Progress mission)
        : code(static_cast<std::uint16_t>(static_cast<unsigned>(mission) << 8 | static_cast<unsigned>(own) << 4 |
                                          static_cast<unsigned>(mental))) {}
    explicit GoalProgress(unsigned known) : code(static_cast<std::uint16_t>(known)) {}
    Progress mental() const { return static_cast<Progress>(code & 15); }  // toward the nearest
    Progress own() const { return static_cast<Progress>(code >> 4 & 15); }
    // Along the best order of all, in the mental model; toward the nearest if there are too many.
    Progress mission() const { return static_cast<Progress>(code >> 8); }
};

// Progress of a robot's step toward what is requested: four bits each.
struct RequestProgress {
    std::uint8_t code = 0;

    RequestProgress(Progress mental, Progress own)
        : code(static_cast<std::uint8_t>(static_cast<unsigned>(mental) << 4 | static_cast<unsigned>(own))) {}
    explicit RequestProgress(std::uint8_t known) : code(known) {}
    Progress mental() const { return static_cast<Progress>(code >> 4); }
    Progress own() const { return static_cast<Progress>(code & 15); }
};

// What toward_goals() has answered last about a step: for which open goals (bits), and what. The same steps are asked about again
// and again while few goals change.
class LastAnswer {
public:
    static constexpr std::size_t kMaxGoals = 48;  // so that there is no key of all ones

    LastAnswer() = default;
    LastAnswer(const LastAnswer& other) : all_(other.all_.load(std::memory_order_relaxed)) {}

    // Whoever asks about the same goals is told the same, in whatever order threads come.
    template <class Find>
    GoalProgress of(std::uint64_t goals, Find find) {
        const auto known = all_.load(std::memory_order_relaxed);
        if (known >> kBits == goals) return GoalProgress(known & ((1u << kBits) - 1));
        const GoalProgress found = find();
        all_.store(goals << kBits | found.code, std::memory_order_relaxed);
        return found;
    }

private:
    static constexpr int kBits = 12;
    std::atomic<std::uint64_t> all_{~std::uint64_t{0}};
};

// What most features ask of an operator, in one cache line.
struct alignas(64) TeamStep {
    std::int32_t schema = -1;  // negative: auxiliary
    bool in_mental = false;    // the mental task has it
    mutable LastAnswer toward_goals;
    std::array<std::int32_t, kMaxArguments> arguments{-1, -1, -1, -1, -1, -1, -1, -1};
};
static_assert(sizeof(TeamStep) == 64);

// What must be known of an operator before it is asked for its features.
struct StepMarks {
    static constexpr std::size_t kMaxGoals = 63;  // with more there are no bits for goals

    std::uint64_t concerned = 0;          // a bit for each goal on which its progress toward the goals depends
    std::uint64_t achieves = 0;           // a bit for each goal
    std::uint32_t adds = 0, deletes = 0;  // some bits for each fact, shared by many
    std::uint32_t fulfils = 0;            // some bit for each request, shared by many
    bool is_human = false;

    static std::uint32_t bit_of(std::int32_t request) { return std::uint32_t{1} << (request & 31); }
    // Quick; false only if this step surely does not take back the earlier one.
    bool may_take_back(const StepMarks& earlier) const { return (adds & ~earlier.deletes) == 0; }
};

class TeamTables {
public:
    // `goal`: facts of the composite task; `is_human`: one flag an object of it. Throws std::invalid_argument if sizes
    // do not fit, and std::length_error if a table would exceed `kMaxEntries`.
    TeamTables(const Task& composite, const Task& mental, const std::vector<FactId>& goal, const MentalNames& names,
               const std::vector<std::uint8_t>& is_human);

    static constexpr std::size_t kMaxEntries = std::size_t{1} << 28;

    std::int32_t num_operators() const { return static_cast<std::int32_t>(steps_.size()) - 1; }
    // -1: no step, of the schema `num_schemas`.
    const TeamStep& operator[](OperatorId step) const { return steps_.data()[step + 1]; }
    const StepMarks& marks(OperatorId step) const { return marks_.data()[step + 1]; }
    bool is_auxiliary(OperatorId step) const { return has_auxiliary_ && (*this)[step].schema < 0; }
    int num_requests() const { return request_facts.size(); }
    // A request stands until all its facts are gone.
    bool stands(const Task& task, const State& state, std::int32_t request) const;

    // `request` may be -1: nothing is requested.
    RequestProgress toward_request(OperatorId step, int request) const {
        if (request < 0) return {Progress::kNoTarget, Progress::kNoTarget};
        return RequestProgress(toward_request_[place_of(step, request)]);
    }
    GoalProgress toward_goals(OperatorId step, const OpenGoals& open) const {
        if (open.none()) return {Progress::kNoTarget, Progress::kNoTarget, Progress::kNoTarget};
        const auto find = [&] { return find_toward_goals(step, open); };
        if (goals.size() > LastAnswer::kMaxGoals) return find();
        return (*this)[step].toward_goals.of(open.bits() & marks(step).concerned, find);
    }
    // The goals that do not hold in a state.
    OpenGoals open_goals(const State& state) const {
        OpenGoals open(goals.size());
        for (std::size_t goal = 0; goal < goals.size(); ++goal)
            if (state.values[places_of_goals_[goal].variable] == places_of_goals_[goal].value) open.close(goal);
        return open;
    }
    // Whether an earlier step, or -1 for none, had deleted all that `step` adds.
    bool takes_back(OperatorId step, OperatorId earlier) const {
        return marks(step).may_take_back(marks(earlier)) && surely_takes_back(step, earlier);
    }

    int num_schemas = 0;
    std::size_t max_arity = 0;
    std::vector<std::size_t> arity;       // of schemas
    Table<FactId> request_facts;          // what a request adds
    std::vector<std::int32_t> asks_for;   // request of a human operator, or -1
    Table<std::int32_t> fulfils;          // requests that a robot's operator fulfils
    std::vector<FactId> goals;
    Table<std::int32_t> achieves;  // goals that an operator adds

private:
    bool surely_takes_back(OperatorId step, OperatorId earlier) const;
    GoalProgress find_toward_goals(OperatorId step, const OpenGoals& open) const;
    void find_requests(const Task& task);
    void find_goals(const Task& task);
    void measure_requests(const class Measure& measure);
    void measure_goals(const class Measure& measure);
    void find_concerned();
    void find_tours(const Task& task, const std::vector<Distance>& distances);

    const Distance* row(std::int32_t place, Model model) const {
        return distances_.data() + (2 * static_cast<std::size_t>(place) + static_cast<std::size_t>(model)) * width_;
    }

    std::size_t place_of(OperatorId step, int request) const {
        return static_cast<std::size_t>(request) * static_cast<std::size_t>(num_operators()) + static_cast<std::size_t>(step);
    }

    std::vector<std::uint8_t> toward_request_;  // request x operator: codes of RequestProgress
    std::vector<TeamStep> steps_;  // that which is none, then all operators
    bool has_auxiliary_ = false;  // operators that are nobody's
    std::vector<StepMarks> marks_;  // of the same
    std::size_t width_ = 0;  // number of goals, padded to a multiple of kLanes by goals to which there is no way
    // A place is a set of facts, as far from a goal as the nearest of them. A step leads from a place to a place.
    std::vector<Distance> distances_;  // place x model x goal
    std::vector<Distance> tours_;  // open goals (bits) x first goal: steps for the others, in the best order
    Table<FactId> adds_, deletes_;
    struct Move {
        std::int32_t from, to;  // places
        bool models_agree;      // on how far they are from all goals
    };
    std::vector<Move> moves_;  // by operator
    struct Value {
        VariableId variable;
        std::int32_t value;
    };
    std::vector<Value> places_of_goals_;
};

}  // namespace explicable
