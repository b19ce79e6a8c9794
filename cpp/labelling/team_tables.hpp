// What the features of a step see of a team task, as flat arrays: who acts, what a human step asks for, and how far
// every step is from every target, in the robot's own model and in the mental model (docs/labelling.md).
#pragma once

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

// The goals that are not fulfilled.
class OpenGoals {
public:
    explicit OpenGoals(std::size_t num_goals) : count_(num_goals), num_open_(num_goals) {
        if (num_goals > few_.size()) many_.resize(num_goals + kLanes);  // read in lanes
        if (num_goals <= kMaxTourGoals) bits_ = (std::uint32_t{1} << num_goals) - 1;
    }
    OpenGoals(const OpenGoals&) = delete;

    void close(std::size_t goal) {
        auto& distance = mask()[goal];
        num_open_ -= distance == 0;
        distance = kNoWay;
        if (count_ <= kMaxTourGoals) bits_ &= ~(std::uint32_t{1} << goal);
    }
    std::size_t num_open() const { return num_open_; }
    std::uint32_t bits() const { return bits_; }  // only if there are no more than kMaxTourGoals
    // kNoWay for a goal that is fulfilled, 0 for an open one.
    const Distance* closed() const { return count_ > few_.size() ? many_.data() : few_.data(); }
    bool is_open(std::size_t goal) const { return closed()[goal] == 0; }

private:
    Distance* mask() { return count_ > few_.size() ? many_.data() : few_.data(); }

    std::array<Distance, 32> few_{};
    std::vector<Distance> many_;
    std::size_t count_, num_open_;
    std::uint32_t bits_ = 0;
};

// Progress of a robot's step toward the open goals.
struct GoalProgress {
    Progress mental, own;  // toward the nearest
    Progress mission;      // along the best order of all, in the mental model; toward the nearest if there are too many
};

// Progress of a robot's step toward what is requested.
struct RequestProgress {
    Progress mental, own;
};

// What most features ask of an operator, in one cache line.
struct alignas(64) TeamStep {
    std::int32_t schema = -1;  // negative: auxiliary
    bool is_human = false;
    bool in_mental = false;  // the mental task has it
    bool fulfils = false;    // some request
    bool achieves = false;   // some goal
    bool models_agree = false;  // on how far its places are from all goals
    std::int32_t from = 0, to = 0;       // places
    std::uint64_t adds = 0, deletes = 0;  // a bit for each fact, shared by many
    std::array<std::int32_t, kMaxArguments> arguments{-1, -1, -1, -1, -1, -1, -1, -1};
};

class TeamTables {
public:
    // `goal`: facts of the composite task; `is_human`: one flag an object of it. Throws std::invalid_argument if sizes
    // do not fit, and std::length_error if a table would exceed `kMaxEntries`.
    TeamTables(const Task& composite, const Task& mental, const std::vector<FactId>& goal, const MentalNames& names,
               const std::vector<std::uint8_t>& is_human);

    static constexpr std::size_t kMaxEntries = std::size_t{1} << 28;

    std::int32_t num_operators() const { return static_cast<std::int32_t>(steps_.size()); }
    const TeamStep& operator[](OperatorId step) const { return steps_[static_cast<std::size_t>(step)]; }
    int num_requests() const { return request_facts.size(); }
    // A request stands until all its facts are gone.
    bool stands(const Task& task, const State& state, std::int32_t request) const;

    // `request` may be -1: nothing is requested.
    RequestProgress toward_request(OperatorId step, int request) const {
        if (request < 0) return {Progress::kNoTarget, Progress::kNoTarget};
        const auto code = toward_request_[static_cast<std::size_t>(step) * static_cast<std::size_t>(num_requests()) +
                                          static_cast<std::size_t>(request)];
        return {static_cast<Progress>(code >> 4), static_cast<Progress>(code & 15)};
    }
    GoalProgress toward_goals(OperatorId step, const OpenGoals& goals) const {
        if (!remembered_) return find_toward_goals(step, goals);
        const unsigned code = remembered_[goals.bits() * steps_.size() + static_cast<std::size_t>(step)].load(std::memory_order_relaxed);
        if (code == 0) return find_toward_goals(step, goals);
        return {static_cast<Progress>(code & 15), static_cast<Progress>(code >> 4 & 15), static_cast<Progress>(code >> 8 & 15)};
    }
    // Asks the processor to fetch what toward_request() and toward_goals() will read.
    void prefetch(OperatorId step, int request, const OpenGoals& goals) const {
        const auto place = static_cast<std::size_t>(step);
        prefetch_line(steps_.data() + place);
        if (request >= 0)
            prefetch_line(toward_request_.data() + place * static_cast<std::size_t>(num_requests()) + static_cast<std::size_t>(request));
        if (remembered_) prefetch_line(remembered_.get() + goals.bits() * steps_.size() + place);
    }
    // Whether an earlier step, or -1 for none, had deleted all that `step` adds.
    bool takes_back(OperatorId step, OperatorId earlier) const {
        if (earlier < 0) return false;
        const auto adds = (*this)[step].adds;
        return adds != 0 && (adds & ~(*this)[earlier].deletes) == 0 && surely_takes_back(step, earlier);
    }
    // Bit kMaxArguments * i + j: argument i of `step` is argument j of `other`.
    std::uint64_t equal_arguments(OperatorId step, OperatorId other) const {
        const auto* const mine = (*this)[step].arguments.data();
        const auto* const theirs = (*this)[other].arguments.data();
        return max_arity <= 4 ? equal_fours(mine, theirs) : equal_eights(mine, theirs);
    }

    int num_schemas = 0;
    std::size_t max_arity = 0;
    Table<FactId> request_facts;          // what a request adds
    std::vector<std::int32_t> asks_for;   // request of a human operator, or -1
    Table<std::int32_t> fulfils;          // requests that a robot's operator fulfils
    std::vector<FactId> goals;
    Table<std::int32_t> achieves;  // goals that an operator adds

private:
    bool surely_takes_back(OperatorId step, OperatorId earlier) const;
    GoalProgress find_toward_goals(OperatorId step, const OpenGoals& goals) const;
    GoalProgress look_toward_goals(OperatorId step, const OpenGoals& goals) const;
    void find_requests(const Task& task);
    void find_goals(const Task& task);
    void measure_requests(const class Measure& measure);
    void measure_goals(const class Measure& measure);
    void find_tours(const Task& task, const std::vector<Distance>& distances);

    const Distance* row(std::int32_t place, Model model) const {
        return distances_.data() + (2 * static_cast<std::size_t>(place) + static_cast<std::size_t>(model)) * width_;
    }

    std::vector<std::uint8_t> toward_request_;  // operator x request: both kinds of progress, four bits each
    std::vector<TeamStep> steps_;
    std::size_t width_ = 0;  // number of goals, padded to a multiple of kLanes by goals to which there is no way
    // A place is a set of facts, as far from a goal as the nearest of them. A step leads from a place to a place.
    std::vector<Distance> distances_;  // place x model x goal
    std::vector<Distance> tours_;  // open goals (bits) x first goal: steps for the others, in the best order
    Table<FactId> adds_, deletes_;
    // What toward_goals() has answered, by open goals (bits) and step; 0: not asked yet. Whoever writes writes the same.
    static constexpr std::size_t kMaxRemembered = std::size_t{1} << 23;
    std::unique_ptr<std::atomic<std::uint16_t>[]> remembered_;
};

}  // namespace explicable
