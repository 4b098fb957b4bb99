// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/viewer_front.h"

#include "earshot/base/random.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/batch_query.h"
#include "earshot/visibility/internal/mesh_touch.h"
#include "earshot/visibility/internal/shaft.h"
#include "earshot/visibility/visibility_matrix.h"

#include <algorithm>
#include <bit>

namespace earshot::visibility {

using geometry::Aabb;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

// Costs are counted in rays of a batch, about 60 ns each.
constexpr double kShaftCost = 2.0;
constexpr double kBoxCost = 0.3;       // of a box against a shaft
constexpr double kTriangleCost = 0.5;  // of a triangle against a shaft
constexpr double kOccluderCost = 2.0;
constexpr double kSearchCost = 6.0;       // of the blocker of a segment
constexpr double kBatchSearchCost = 3.0;  // the same in a batch

/// What proofs may cost: at first as much as some batches, then a part of what asking all points in
/// a batch costs, and a part of what proofs have saved. So a walk is at most that much slower than
/// batches. What is left is kept for turns, where all proofs end in one frame.
constexpr double kFirstBudget = 4.0;  // of a batch
constexpr double kMaxBudget = 8.0;    // of a batch
constexpr double kBudgetOfPoints = 0.01;
constexpr double kBudgetOfSavings = 0.6;

/// What proofs of a unit may cost, for each of its points: more the more budget is left, in
/// batches, and the more points they decide. So those that cost little are found where many fail.
constexpr double kMinMaxLoss = 1.0;
constexpr double kMaxLossOfBudget = 0.8;
constexpr double kMaxCostOfDecided = 12.0;

/// The part of the budget that searches of blockers may take in a frame.
constexpr double kMaxSearchesOfBudget = 0.5;

// Counts of what the last blockers have done fade by this much from frame to frame.
constexpr double kForget = 0.9;

constexpr double kLowShare = 0.7, kHighShare = 0.9;
constexpr unsigned kMinHorizon = 1;
constexpr unsigned kMaxHorizonAfterTurn = 4;
constexpr unsigned kMaxHorizon = 6;

/// A step that differs from the last one by more than this part of it is a turn.
constexpr double kTurn = 0.25;
constexpr unsigned kMaxPatience = 8;  // failures, each of which doubles the frames until the next

/// Longer lists are not worth their parts: each of these is listed for itself.
constexpr std::size_t kMaxListed = 12;
constexpr std::size_t kMinListedPoints = 2;

/// The sides of the viewer's way ahead, in parts of its length.
constexpr double kSidewards = 0.05;

}  // namespace

/// The proofs of a unit that are being made.
class ViewerFront::Renewal {
public:
    Renewal(ViewerFront& front, const GroupFrame& frame, Unit& unit, double max_loss)
        : front_(front), frame_(frame), unit_(unit), max_cost_(max_loss) {}

    /// Of points that are decided.
    std::size_t decided() const noexcept { return decided_; }
    double cost() const noexcept { return cost_; }

    /// What was visible in the last frame may be still, and so may what was hidden.
    void divide(std::uint32_t node) {
        const auto first = front_.was_visible_.begin() + frame_.groups->begin_of(node);
        const auto last = front_.was_visible_.begin() + frame_.groups->end_of(node);
        const bool was_visible = *first != 0;
        if (is_leaf(node) ||
            std::all_of(first, last, [&](std::uint8_t v) { return (v != 0) == was_visible; })) {
            was_visible ? list_and_divide(node) : hide(node);
        } else {
            divide(child_of(node, 0));
            divide(child_of(node, 1));
        }
    }

private:
    std::uint32_t child_of(std::uint32_t node, std::uint32_t index) const {
        return frame_.groups->nodes()[node].first + index;
    }
    bool is_exhausted() const { return cost_ >= max_cost_; }
    bool is_leaf(std::uint32_t node) const { return frame_.groups->nodes()[node].is_leaf(); }
    Shaft shaft_of(std::uint32_t node) const {
        return {unit_.region, frame_.groups->nodes()[node].box, frame_.bvh->max_abs_coordinate()};
    }

    /// Proves that the node or parts of it are hidden.
    void hide(std::uint32_t node) {
        if (!is_exhausted() && is_hidden(node)) {
            set(node, Verdict::hidden);
        } else if (is_leaf(node) || is_exhausted()) {
            set(node, Verdict::undecided);
        } else {
            hide(child_of(node, 0));
            hide(child_of(node, 1));
        }
    }

    bool is_hidden(std::uint32_t node) {
        for (std::size_t i = 0; i < unit_.occluder_count; ++i) {
            if (hides(unit_.occluders[i], node)) {
                std::rotate(unit_.occluders.begin(),
                            unit_.occluders.begin() + static_cast<std::ptrdiff_t>(i),
                            unit_.occluders.begin() + static_cast<std::ptrdiff_t>(i) + 1);
                return true;
            }
        }
        // What hides one of the points may hide all.
        const TriangleId blocker = blocker_of(frame_.groups->begin_of(node));
        if (blocker == kNoBlocker) {
            return false;
        }
        const Id patch = frame_.occluders->of_triangle(blocker);
        for (const Id occluder : {patch, Id{blocker}}) {
            const auto end = unit_.occluders.begin() + unit_.occluder_count;
            if (std::find(unit_.occluders.begin(), end, occluder) == end && hides(occluder, node)) {
                remember(occluder);
                return true;
            }
            if (patch == blocker) {
                break;
            }
        }
        return false;
    }

    TriangleId blocker_of(std::uint32_t place) {
        TriangleId& blocker = front_.blockers_[place];
        if (blocker == kNoBlocker) {
            const Vec3& point = frame_.groups->points()[frame_.groups->order()[place]];
            const std::optional<geometry::Hit> hit =
                frame_.bvh->closest_hit({front_.position_, point - front_.position_, 1.0});
            if (hit && !frame_.excluded->contains(hit->triangle)) {
                blocker = hit->triangle;
            }
            cost_ += kSearchCost;
            ++front_.statistics_.searches;
        }
        return blocker;
    }

    /// Proves that the node or parts of it are visible. Lists the triangles in its shaft.
    void list_and_divide(std::uint32_t node) {
        const Shaft shaft = shaft_of(node);
        std::vector<TriangleId> listed;
        const std::size_t max_listed = is_leaf(node) ? 0 : kMaxListed;
        cost_ += kShaftCost;
        frame_.bvh->traverse(
            [&](const Aabb& box) {
                cost_ += kBoxCost;
                return shaft.may_touch(box);
            },
            [&](TriangleId id) {
                cost_ += kTriangleCost;
                if (!frame_.excluded->contains(id) && shaft.may_touch(frame_.bvh->corners(id))) {
                    listed.push_back(id);
                }
                return listed.size() <= max_listed && !is_exhausted();
            });
        ++front_.statistics_.shafts;
        if (is_exhausted()) {
            set(node, Verdict::undecided);  // the list may lack some
            return;
        }
        if (listed.size() <= max_listed) {
            decide_visible(node, listed);
        } else if (frame_.groups->count_of(node) < 2 * kMinListedPoints) {
            set(node, Verdict::undecided);
        } else {
            list_and_divide(child_of(node, 0));
            list_and_divide(child_of(node, 1));
        }
    }

    /// `listed`: the triangles in the shaft of the node.
    void decide_visible(std::uint32_t node, std::span<const TriangleId> listed) {
        if (listed.empty()) {
            set(node, Verdict::visible);
            return;
        }
        if (is_leaf(node)) {
            set(node, Verdict::undecided);
            return;
        }
        for (const std::uint32_t child : {child_of(node, 0), child_of(node, 1)}) {
            const Shaft shaft = shaft_of(child);
            std::vector<TriangleId> of_child;
            for (const TriangleId id : listed) {
                if (shaft.may_touch(frame_.bvh->corners(id))) {
                    of_child.push_back(id);
                }
            }
            cost_ += kShaftCost + kTriangleCost * static_cast<double>(listed.size());
            decide_visible(child, of_child);
        }
    }

    bool hides(Id occluder, std::uint32_t node) {
        ++front_.statistics_.occluder_tests;
        cost_ += kOccluderCost;
        return frame_.occluders->hides(
            frame_.bvh->mesh(), occluder, unit_.region, frame_.groups->nodes()[node].box);
    }

    void remember(Id occluder) {
        unit_.occluder_count =
            std::min(unit_.occluder_count + 1, static_cast<std::uint32_t>(kMaxRemembered));
        std::rotate(unit_.occluders.begin(),
                    unit_.occluders.begin() + unit_.occluder_count - 1,
                    unit_.occluders.begin() + unit_.occluder_count);
        unit_.occluders[0] = occluder;
    }

    void set(std::uint32_t node, Verdict verdict) {
        const std::size_t count = frame_.groups->count_of(node);
        std::fill_n(front_.verdicts_.begin() + frame_.groups->begin_of(node), count, verdict);
        if (verdict != Verdict::undecided) {
            decided_ += count;
            max_cost_ += kMaxCostOfDecided * static_cast<double>(count);
        }
    }

    ViewerFront& front_;
    const GroupFrame& frame_;
    Unit& unit_;
    double max_cost_;  // grows with what is decided: proofs that fail are given up early
    std::size_t decided_ = 0;
    double cost_ = 0.0;
};

ViewerFront::ViewerFront(const PointGroups& groups)
    : units_(groups.units().size()),
      budget_(kFirstBudget * static_cast<double>(groups.point_count())),
      verdicts_(groups.point_count(), Verdict::undecided),
      blockers_(groups.point_count(), kNoBlocker),
      was_visible_(groups.point_count(), 0) {}

void ViewerFront::begin_frame(const GroupFrame& frame, const Vec3& position) {
    const auto points = static_cast<double>(frame.groups->point_count());
    budget_ = std::min(budget_ + kBudgetOfPoints * points, kMaxBudget * points);
    // Nothing is known of the way of a viewer that was not asked in the last frame.
    const bool knew_step = knows_step_;
    knows_step_ = frame_ != 0 && frame_ + 1 == frame.number;
    const Vec3 step = position - position_;
    if (knew_step && geometry::max_abs(step - step_) <= kTurn * geometry::max_abs(step)) {
        ++frames_since_turn_;
    } else {
        frames_before_turn_ = frames_since_turn_;
        frames_since_turn_ = 0;
    }
    step_ = step;
    position_ = position;
    frame_ = frame.number;
    statistics_ = {};
    blocker_tests_ = 0;
}

/// Where the viewer will be. Lengths differ from unit to unit, so that not all proofs end in one
/// frame (Mattausch et al. 2008, section 4.2).
ViewerRegion ViewerFront::region_ahead(std::uint32_t node, unsigned horizon) const {
    if (step_ == Vec3(0.0)) {
        return ViewerRegion(position_);
    }
    const double frames =
        static_cast<double>(1U << horizon) * (0.75 + 0.5 * random(1, frame_, node));
    return {position_, position_ + frames * step_, kSidewards * frames * geometry::max_abs(step_)};
}

bool ViewerFront::holds(const GroupFrame& frame, std::uint32_t node, Unit& unit) const {
    if (!unit.is_proved || unit.version != frame.groups->version(node) ||
        !unit.region.contains(position_) || unit.checked < frame.last_motion_before) {
        return false;
    }
    // What moves elsewhere can neither free a line of sight from its occluder nor block one.
    if (frame.last_motion == frame.number &&
        Shaft(unit.region, frame.groups->nodes()[node].box, frame.bvh->max_abs_coordinate())
            .may_touch(frame.moved_box)) {
        return false;
    }
    unit.checked = frame.number;
    return true;
}

void ViewerFront::renew(const GroupFrame& frame, std::uint32_t node, Unit& unit) {
    // Proofs for much longer than the viewer has gone straight on, or than the last ones have held,
    // are in vain.
    unsigned max_horizon = std::clamp(static_cast<unsigned>(std::bit_width(frames_since_turn_)),
                                      kMaxHorizonAfterTurn,
                                      kMaxHorizon);
    if (unit.is_proved) {
        const auto doublings = static_cast<unsigned>(std::bit_width(frame.number - unit.made)) + 1;
        max_horizon = std::clamp(doublings, kMinHorizon, max_horizon);
    }
    unit.horizon = static_cast<std::uint8_t>(std::min<unsigned>(unit.horizon, max_horizon));
    unit.region = region_ahead(node, unit.horizon);
    unit.version = frame.groups->version(node);
    unit.made = unit.checked = frame.number;

    const auto points = static_cast<double>(frame.groups->count_of(node));
    const double batches = budget_ / static_cast<double>(frame.groups->point_count());
    Renewal renewal(*this, frame, unit, (kMinMaxLoss + kMaxLossOfBudget * batches) * points);
    renewal.divide(node);
    budget_ -= renewal.cost();
    unit.is_proved = renewal.decided() > 0;
    schedule(frame, node, unit, renewal);
    const double share = static_cast<double>(renewal.decided()) / points;
    if (share < kLowShare && unit.horizon > kMinHorizon) {
        --unit.horizon;
    } else if (share > kHighShare && unit.horizon < max_horizon) {
        ++unit.horizon;
    }
}

/// Where proofs have cost more than they can save the next ones are put off, for longer each time.
void ViewerFront::schedule(const GroupFrame& frame,
                           std::uint32_t node,
                           Unit& unit,
                           const Renewal& renewal) const {
    const double saved =
        static_cast<double>(renewal.decided()) * static_cast<double>(1U << unit.horizon);
    if (saved > renewal.cost()) {
        unit.failures = 0;
        return;
    }
    unit.failures = static_cast<std::uint8_t>(std::min(unit.failures + 1U, kMaxPatience));
    const double jitter = 0.75 + 0.5 * random(2, frame.number, node);
    unit.next_test = frame.number +
                     static_cast<std::uint32_t>(jitter * static_cast<double>(2U << unit.failures));
}

bool ViewerFront::is_hidden_by_last(const GroupFrame& frame, std::uint32_t place) {
    if (blockers_[place] == kNoBlocker) {
        return false;
    }
    ++blocker_tests_;
    const Vec3& point = frame.groups->points()[frame.groups->order()[place]];
    if (touches({position_, point}, frame.bvh->mesh(), blockers_[place])) {
        ++statistics_.kept;
        return true;
    }
    blockers_[place] = kNoBlocker;
    return false;
}

void ViewerFront::decide(const GroupFrame& frame,
                         const Vec3& position,
                         std::span<std::uint8_t> visible,
                         Executor& executor) {
    begin_frame(frame, position);
    const std::span<const std::uint32_t> order = frame.groups->order();
    undecided_.clear();
    for (std::size_t i = 0; i < units_.size(); ++i) {
        Unit& unit = units_[i];
        const std::uint32_t node = frame.groups->units()[i];
        bool is_proved = holds(frame, node, unit);
        if (!is_proved && can_prove() && frame.number >= unit.next_test) {
            renew(frame, node, unit);
            is_proved = unit.is_proved;
        }
        const std::uint32_t end = frame.groups->end_of(node);
        for (std::uint32_t place = frame.groups->begin_of(node); place < end; ++place) {
            Verdict verdict = is_proved ? verdicts_[place] : Verdict::undecided;
            if (verdict != Verdict::undecided) {
                ++statistics_.decided;
            } else if (is_hidden_by_last(frame, place)) {
                verdict = Verdict::hidden;
            } else {
                undecided_.push_back(place);
            }
            was_visible_[place] = visible[order[place]] = verdict == Verdict::visible ? 1 : 0;
        }
    }
    budget_ += kBudgetOfSavings * static_cast<double>(statistics_.decided);
    cast_rays(frame, visible, executor);
}

// Points that no group decides, and that their last blocker does not hide.
void ViewerFront::cast_rays(const GroupFrame& frame,
                            std::span<std::uint8_t> visible,
                            Executor& executor) {
    const std::span<const std::uint32_t> order = frame.groups->order();
    segments_.clear();
    for (const std::uint32_t place : undecided_) {
        segments_.push_back({position_, frame.groups->points()[order[place]]});
    }
    answers_.resize(segments_.size());
    query_batch(*frame.bvh, segments_, *frame.excluded, std::span(answers_), executor);
    statistics_.rays += segments_.size();
    blocked_.clear();
    for (std::size_t i = 0; i < undecided_.size(); ++i) {
        const std::uint32_t place = undecided_[i];
        was_visible_[place] = visible[order[place]] = answers_[i];
        if (answers_[i] == 0) {
            blocked_.push_back(place);
        }
    }
    // A blocker pays if it holds for more frames than looking for it costs rays.
    tested_blockers_ = kForget * tested_blockers_ + static_cast<double>(blocker_tests_);
    kept_blockers_ = kForget * kept_blockers_ + static_cast<double>(statistics_.kept);
    if (can_prove() &&
        kept_blockers_ >= (1.0 - 1.0 / (kBatchSearchCost + 1.0)) * tested_blockers_) {
        find_blockers(frame, executor);
    }
}

// The closest hit of a ray is not decided as exactly as a line of sight, but only tested later.
void ViewerFront::find_blockers(const GroupFrame& frame, Executor& executor) {
    const double max_searches = kMaxSearchesOfBudget * budget_ / kBatchSearchCost;
    const std::size_t count = std::min(blocked_.size(), static_cast<std::size_t>(max_searches));
    rays_.clear();
    for (const std::uint32_t place : std::span(blocked_).first(count)) {
        const Vec3& point = frame.groups->points()[frame.groups->order()[place]];
        rays_.push_back({position_, point - position_, 1.0});
    }
    hits_.resize(count);
    frame.bvh->closest_hits(rays_, std::span(hits_), executor);
    for (std::size_t i = 0; i < count; ++i) {
        if (hits_[i] && !frame.excluded->contains(hits_[i]->triangle)) {
            blockers_[blocked_[i]] = hits_[i]->triangle;
        }
    }
    budget_ -= kBatchSearchCost * static_cast<double>(count);
    statistics_.searches += count;
}

}  // namespace earshot::visibility
