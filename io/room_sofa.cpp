// SPDX-License-Identifier: MIT
#include "earshot/io/room_sofa.h"

#include "earshot/audio/spatial.h"
#include "earshot/base/assert.h"
#include "earshot/io/internal/netcdf4_writer.h"

#include <algorithm>
#include <utility>

namespace earshot::io {

namespace {

using geometry::Vec3;
using propagation::Channels;

const std::vector<TextAttribute> kCartesian = {{"Type", "cartesian"}, {"Units", "metre"}};

/// What the receivers of a file are.
struct Receivers {
    std::vector<double> positions;  ///< R x C
    std::vector<TextAttribute> position_attributes = kCartesian;
    std::string description;
    /// Of the samples and of the file, beside what every file has.
    std::vector<TextAttribute> sample_attributes{}, file_attributes{};
};

/// The order of (order + 1)^2 channels.
int ambisonic_order(std::size_t channels) {
    int order = 0;
    while (audio::ambisonic_channels(order) < channels) {
        ++order;
    }
    EARSHOT_ASSERT(audio::ambisonic_channels(order) == channels);
    return order;
}

Receivers receivers_of(Channels kind, std::size_t channels) {
    // Where AES69 puts the ears by default, front, left, up.
    constexpr double kEar = 0.09;
    switch (kind) {
        case Channels::mono:
            break;
        case Channels::binaural:
            EARSHOT_ASSERT(channels == 2);
            return {.positions = {0.0, kEar, 0.0, 0.0, -kEar, 0.0},
                    .description = "left ear, right ear"};
        case Channels::ambisonic: {
            // AES69-2022: channels that are coefficients of spherical harmonics have this type of
            // position; they stand for the sound field at one point.
            const std::string order = std::to_string(ambisonic_order(channels));
            return {.positions = std::vector<double>(3 * channels, 0.0),
                    .position_attributes = {{"Type", "spherical harmonics"},
                                            {"Units", "degree, degree, metre"}},
                    .description = "real spherical harmonics up to order " + order +
                                   ", ACN order, SN3D normalisation (AmbiX)",
                    .sample_attributes = {{"ChannelOrdering", "acn"}, {"Normalization", "sn3d"}},
                    .file_attributes = {{"AmbisonicsOrder", order}}};
        }
    }
    return {.positions = std::vector<double>(3 * channels, 0.0),
            .description = "omnidirectional pressure"};
}

/// Bytes of an attribute in the heap of a file: name with a zero, text, sizes, type and extent.
std::size_t heap_size(const TextAttribute& attribute) {
    return attribute.first.size() + 1 + attribute.second.size() + 21;
}

// HDF5 keeps more than eight attributes in a heap of blocks of 1,024 bytes. libmysofa 1.3 reads a
// block object by object until a zero follows, and refuses a file in which an object ends within
// some bytes of the block's end. So the objects of all attributes but the title fit into the first
// block and have a multiple of 16 bytes in sum, and so has the title, in whichever block: of the
// 1,002 bytes of a block behind its header 10 or more remain.
constexpr std::size_t kHeapUnit = 16;
constexpr std::size_t kHeapBlock = 1002;

void pad(std::string& text, std::size_t size) {
    text.append((kHeapUnit - size % kHeapUnit) % kHeapUnit, ' ');
}

/// At most 200 bytes of a title.
TextAttribute title_attribute(std::string title) {
    std::size_t size = std::min<std::size_t>(title.size(), 200);
    while (size < title.size() && (title[size] & 0xc0) == 0x80) {
        --size;  // not within a character of UTF-8
    }
    title.resize(size);
    TextAttribute attribute = {"Title", title};
    pad(attribute.second, heap_size(attribute));
    return attribute;
}

void describe(const std::string& title, const Receivers& receivers, Netcdf4Writer& file) {
    constexpr const char* kNoDate = "1970-01-01 00:00:00";
    std::vector<TextAttribute> attributes = {{"Conventions", "SOFA"},
                                             {"Version", "2.1"},
                                             {"SOFAConventions", "SingleRoomSRIR"},
                                             {"SOFAConventionsVersion", "1.0"},
                                             {"DataType", "FIR"},
                                             {"RoomType", "reverberant"},
                                             {"RoomDescription", "simulated by earshot"},
                                             {"DatabaseName", "earshot"},
                                             {"ReceiverDescription", receivers.description},
                                             {"APIName", "earshot"},
                                             {"APIVersion", "1"},
                                             {"AuthorContact", "none"},
                                             {"Organization", "none"},
                                             {"License", "none"},
                                             {"DateCreated", kNoDate},
                                             {"DateModified", kNoDate}};
    attributes.insert(
        attributes.end(), receivers.file_attributes.begin(), receivers.file_attributes.end());
    attributes.emplace_back("Comment", "Pressure re the free field at 1 m in front of the source.");
    std::size_t size = 0;
    for (const TextAttribute& attribute : attributes) {
        size += heap_size(attribute);
    }
    pad(attributes.back().second, size);
    EARSHOT_ASSERT(size + kHeapUnit <= kHeapBlock);
    attributes.push_back(title_attribute(title));
    for (const TextAttribute& attribute : attributes) {
        file.add_attribute(attribute);
    }
}

void add_vector(const Vec3& v, std::vector<double>& values) {
    values.insert(values.end(), {v.x, -v.z, v.y});
}

/// A vector of every measurement, in SOFA's axes.
std::vector<double> vectors(const std::vector<RoomMeasurement>& measurements,
                            propagation::Pose RoomMeasurement::*pose,
                            Vec3 propagation::Pose::*vector) {
    std::vector<double> values;
    for (const RoomMeasurement& measurement : measurements) {
        add_vector(measurement.*pose.*vector, values);
    }
    return values;
}

/// All samples, measurement by measurement and channel by channel, with zeros up to `length`.
std::vector<double> samples_of(const std::vector<RoomMeasurement>& measurements,
                               std::size_t length) {
    std::vector<double> samples;
    samples.reserve(measurements.size() * measurements.front().channels.size() * length);
    for (const RoomMeasurement& measurement : measurements) {
        for (const audio::ImpulseResponse& channel : measurement.channels) {
            samples.insert(samples.end(), channel.samples.begin(), channel.samples.end());
            samples.resize(samples.size() + length - channel.samples.size(), 0.0);
        }
    }
    return samples;
}

}  // namespace

std::string encode_room_responses(const std::string& title,
                                  Channels kind,
                                  const std::vector<RoomMeasurement>& measurements) {
    EARSHOT_ASSERT(!measurements.empty());
    const std::size_t channels = measurements.front().channels.size();
    const Receivers receivers = receivers_of(kind, channels);
    std::size_t length = 1;
    for (const RoomMeasurement& measurement : measurements) {
        length = std::max(length, measurement.channels.front().samples.size());
    }
    Netcdf4Writer file("responses.sofa");
    describe(title, receivers, file);
    file.add_dimension('M', measurements.size());
    file.add_dimension('R', channels);
    file.add_dimension('N', length);
    file.add_dimension('E', 1);
    file.add_dimension('C', 3);
    file.add_dimension('I', 1);
    using propagation::Pose;
    const auto of_all = [&](auto pose, auto vector) { return vectors(measurements, pose, vector); };
    file.add_variable(
        "ListenerPosition", "MC", of_all(&RoomMeasurement::listener, &Pose::position), kCartesian);
    file.add_variable(
        "ListenerView", "MC", of_all(&RoomMeasurement::listener, &Pose::front), kCartesian);
    file.add_variable("ListenerUp", "MC", of_all(&RoomMeasurement::listener, &Pose::up));
    file.add_variable(
        "ReceiverPosition", "RCI", receivers.positions, receivers.position_attributes);
    file.add_variable(
        "SourcePosition", "MC", of_all(&RoomMeasurement::source, &Pose::position), kCartesian);
    file.add_variable(
        "SourceView", "MC", of_all(&RoomMeasurement::source, &Pose::front), kCartesian);
    file.add_variable("SourceUp", "MC", of_all(&RoomMeasurement::source, &Pose::up));
    file.add_variable("EmitterPosition", "ECI", {0.0, 0.0, 0.0}, kCartesian);
    file.add_variable(
        "Data.IR", "MRN", samples_of(measurements, length), receivers.sample_attributes);
    file.add_variable("Data.Delay", "IR", std::vector<double>(channels, 0.0));
    file.add_variable("Data.SamplingRate",
                      "I",
                      {measurements.front().channels.front().sample_rate},
                      {{"Units", "hertz"}});
    return file.finish();
}

}  // namespace earshot::io
