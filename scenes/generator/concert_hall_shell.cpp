// SPDX-License-Identifier: MIT
#include "earshot/scenes/concert_hall_plan.h"

#include <algorithm>

namespace earshot::scenes {

using namespace plan;

namespace {

// Carves the hall step by step.
class Shell {
public:
    explicit Shell(const HallMaterials& materials) : materials_(materials), hall_(materials.wall) {}

    Faces build(Seats seats) {
        hall_.carve(room());
        hall_.divide(2, kStageEdge);
        walls();
        floor();
        if (seats == Seats::blocks) {
            seat_blocks();
        }
        side_balcony(-1.0);
        side_balcony(1.0);
        rear_balcony();
        ceiling();
        organ();
        doors();
        Faces faces = hall_.surface();
        splay_stage(faces);
        return faces;
    }

private:
    static Box room() { return {{-kHalfWidth, 0.0, 0.0}, {kHalfWidth, kCeiling, kLength}}; }

    // The same box on either side of the hall; `from` and `to` count from the middle.
    static Box on_side(double side, Vec3 from, Vec3 to) {
        from.x *= side;
        to.x *= side;
        return {{std::min(from.x, to.x), from.y, from.z}, {std::max(from.x, to.x), to.y, to.z}};
    }

    // Wood below, plaster above, pilasters that scatter; an absorbing rear wall.
    void walls() {
        hall_.paint({{-kHalfWidth, 0.0, 0.0}, {kHalfWidth, 3.0, kLength}}, materials_.panelling);
        hall_.paint({{-kHalfWidth, 0.0, kLength}, {kHalfWidth, kCeiling, kLength}},
                    materials_.rear_wall,
                    Facing::back);
        for (const double side : {-1.0, 1.0}) {
            for (int pilaster = 0; pilaster < 5; ++pilaster) {
                const double z = 14.2 + 6.1 * pilaster;
                hall_.fill(on_side(
                    side, {kHalfWidth - 0.35, kParapet + 0.8, z}, {kHalfWidth, kCeiling, z + 0.9}));
            }
        }
    }

    // The stage with two risers, and stalls that climb towards the rear.
    void floor() {
        hall_.fill({{-kHalfWidth, 0.0, 0.0}, {kHalfWidth, kStage, kStageEdge}});
        hall_.fill({{-6.5, kStage, 0.0}, {6.5, kStage + 0.35, 5.6}});
        hall_.fill({{-6.5, kStage, 0.0}, {6.5, kStage + 0.70, 3.2}});
        hall_.paint({{-kHalfWidth, 0.0, 0.0}, {kHalfWidth, kStage + 0.7, kStageEdge}},
                    materials_.stage,
                    Facing::up);
        hall_.paint({{-6.5, kStage, 0.0}, {6.5, kStage + 0.7, 5.6}}, materials_.stage);
        for (int row = kFlatRows; row < kRows; row += 2) {
            hall_.fill({{-kHalfWidth, 0.0, kFirstRow + kRowPitch * row},
                        {kHalfWidth, floor_of_row(row), kLength}});
        }
        const Box stalls{{-kHalfWidth, 0.0, kStageEdge},
                         {kHalfWidth, floor_of_row(kRows - 1), kLength}};
        hall_.paint(stalls, materials_.floor, Facing::up);
        hall_.paint({stalls.low + Vec3(0.0, 0.0, 0.5), stalls.high - Vec3(0.0, 0.0, 0.5)},
                    materials_.floor,
                    Facing::back);
    }

    // A section of seats as one stepped block, as high as the seats' backs.
    void seat_blocks() {
        for (const Section& section : kSections) {
            for (int row = 0; row < kRows; row += row < kFlatRows ? kFlatRows : 2) {
                const int next = std::min(row + (row < kFlatRows ? kFlatRows : 2), kRows);
                const double y = floor_of_row(row);
                const Box block{{section.left, y, kFirstRow + kRowPitch * row + 0.3},
                                {section.left + kSeatWidth * section.seats,
                                 y + 0.8,
                                 kFirstRow + kRowPitch * next + 0.3}};
                hall_.fill(block);
                hall_.paint(block, materials_.seat);
            }
        }
    }

    void side_balcony(double side) {
        const double front = kHalfWidth - kSideDepth;
        const double end = kRearStart + kParapetWidth;
        const auto add = [&](const Vec3& from, const Vec3& to, std::size_t material) {
            const Box box = on_side(side, from, to);
            hall_.fill(box);
            hall_.paint(box, material);
        };
        add({front, kBalcony, kSideStart}, {kHalfWidth, kBalconyFloor, end}, materials_.balcony);
        add({front, kBalconyFloor, kSideStart},
            {front + kParapetWidth, kParapet, end},
            materials_.balcony);
        add({front + kParapetWidth, kBalconyFloor, kSideStart},
            {kHalfWidth, kParapet, kSideStart + kParapetWidth},
            materials_.balcony);
        add({front + 0.9, kBalconyFloor, kSideStart + 1.0},
            {front + 1.4, kBalconyFloor + 0.45, kRearStart - 1.0},
            materials_.bench);
    }

    // Four rows of benches on steps, and a walk behind them.
    void rear_balcony() {
        const double front = kHalfWidth - kSideDepth;
        const auto add = [&](const Box& box, std::size_t material) {
            hall_.fill(box);
            hall_.paint(box, material);
        };
        add({{-kHalfWidth, kBalcony, kRearStart}, {kHalfWidth, kBalconyFloor, kLength}},
            materials_.balcony);
        add({{-front - kParapetWidth, kBalconyFloor, kRearStart},
             {front + kParapetWidth, kParapet, kRearStart + kParapetWidth}},
            materials_.balcony);
        for (int row = 0; row < 4; ++row) {
            const double z = kRearStart + 2.4 + 1.5 * row;
            const double y = kBalconyFloor + 0.4 * (row + 1);
            add({{-kHalfWidth, kBalconyFloor, z}, {kHalfWidth, y, kLength}}, materials_.balcony);
            for (const double side : {-1.0, 1.0}) {
                add(on_side(side, {0.65, y, z + 0.7}, {8.6, y + 0.45, z + 1.2}), materials_.bench);
            }
        }
        hall_.paint({{-kHalfWidth, kBalconyFloor, kLength}, {kHalfWidth, kCeiling, kLength}},
                    materials_.rear_wall,
                    Facing::back);
    }

    // Coffers: 4 across, 7 along.
    void ceiling() {
        hall_.paint({{-kHalfWidth, kCeiling, 0.0}, {kHalfWidth, kCeiling, kLength}},
                    materials_.ceiling);
        for (int across = 0; across < 4; ++across) {
            for (int along = 0; along < 7; ++along) {
                const double x = -9.2 + 4.7 * across;
                const double z = 0.9 + 5.95 * along;
                // The plane of the stage edge does not cut a coffer: one ends before, one after.
                const double shift = along == 2 ? 0.3 : 0.0;
                const Box coffer{{x, kCeiling, z + shift}, {x + 4.3, kTop, z + 4.6}};
                hall_.carve(coffer);
                hall_.paint(coffer, materials_.coffer);
            }
        }
    }

    // An organ case before the rear wall of the stage, with pipes of different heights.
    void organ() {
        const Box case_box{{-5.1, kStage + 2.9, 0.0}, {5.1, 11.0, 0.8}};
        hall_.fill(case_box);
        hall_.paint(case_box, materials_.organ);
        for (int pipe = -4; pipe <= 4; ++pipe) {
            const double x = 1.1 * pipe;
            const double top = 10.4 - 0.23 * (pipe % 2 == 0 ? pipe * pipe : 20 - pipe * pipe);
            const Box box{{x - 0.3, kStage + 3.4, 0.8}, {x + 0.3, top, 1.05 + 0.03 * (pipe + 4)}};
            hall_.fill(box);
            hall_.paint(box, materials_.organ);
        }
    }

    // Doors lie 0.12 m deep in their frames.
    void doors() {
        const auto add = [&](const Box& recess, Facing facing) {
            hall_.carve(recess);
            hall_.paint(recess, materials_.door, facing);
        };
        const double y = floor_of_row(kRows - 1);
        for (const double side : {-1.0, 1.0}) {
            const Facing inwards = side < 0.0 ? Facing::right : Facing::left;
            add(on_side(side, {kHalfWidth, 0.0, 12.2}, {kHalfWidth + 0.12, 2.4, 13.7}), inwards);
            add(on_side(side, {kHalfWidth, y, 39.3}, {kHalfWidth + 0.12, y + 2.4, 41.1}), inwards);
            add(on_side(side, {1.2, y, kLength}, {3.0, y + 2.4, kLength + 0.12}), Facing::back);
        }
    }

    // The orchestra shell narrows and sinks towards its rear: all that lies before the stage edge
    // is scaled about the floor of the stage. Planes stay planes.
    static void splay_stage(Faces& faces) {
        constexpr double kRearScale = 0.72;
        for (Face& face : faces) {
            for (std::size_t i = 0; i < face.corner_count; ++i) {
                Vec3& at = face.corners[i];
                if (at.z < kStageEdge && at.y >= kStage) {
                    const double scale = kRearScale + (1.0 - kRearScale) * at.z / kStageEdge;
                    at.x *= scale;
                    at.y = kStage + (at.y - kStage) * scale;
                }
            }
        }
    }

    const HallMaterials& materials_;
    Carving hall_;
};

}  // namespace

double floor_of_row(int row) {
    const int steps = row < kFlatRows ? 0 : 1 + (row - kFlatRows) / 2;
    return kStep * steps;
}

Faces hall_shell(const HallMaterials& materials, Seats seats) {
    return Shell(materials).build(seats);
}

}  // namespace earshot::scenes
