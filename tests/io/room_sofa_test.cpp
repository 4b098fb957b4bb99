// SPDX-License-Identifier: MIT
// Written through HDF5, read back by libmysofa, which has a reader of its own.
#include "earshot/io/room_sofa.h"

#include <gtest/gtest.h>
#include <mysofa.h>

#include "support/temporary_folder.h"
#include <cstring>
#include <utility>

namespace earshot::io {
namespace {

std::vector<RoomMeasurement> two_measurements() {
    RoomMeasurement first;
    first.source.position = {1.0, 2.0, 3.0};
    first.listener.position = {4.0, 5.0, 6.0};
    first.channels = {{48000.0, {0.0, 0.5, -0.25}}, {48000.0, {1.0, 0.0, 0.125}}};
    RoomMeasurement second = first;
    second.listener.position = {-4.0, 1.0, 0.5};
    second.channels = {{48000.0, {0.75, 2.0}}, {48000.0, {3.0, 4.0}}};
    return {first, second};
}

std::vector<float> values_of(const MYSOFA_ARRAY& array) {
    return {array.values, array.values + array.elements};
}

TEST(RoomSofa, IsReadBackByAnotherReader) {
    const test::TemporaryFolder folder;
    const auto file = folder.file(
        "room.sofa",
        encode_room_responses("hall", propagation::Channels::binaural, two_measurements()));
    int fault = MYSOFA_OK;
    MYSOFA_HRTF* sofa = mysofa_load(file.c_str(), &fault);
    ASSERT_EQ(fault, MYSOFA_OK);
    ASSERT_NE(sofa, nullptr);
    EXPECT_EQ(sofa->M, 2U);
    EXPECT_EQ(sofa->R, 2U);
    EXPECT_EQ(sofa->N, 3U);
    EXPECT_EQ(values_of(sofa->DataIR),
              (std::vector<float>{
                  0.0F, 0.5F, -0.25F, 1.0F, 0.0F, 0.125F, 0.75F, 2.0F, 0.0F, 3.0F, 4.0F, 0.0F}));
    EXPECT_EQ(values_of(sofa->DataSamplingRate), (std::vector<float>{48000.0F}));
    // x, -z, y
    EXPECT_EQ(values_of(sofa->SourcePosition),
              (std::vector<float>{1.0F, -3.0F, 2.0F, 1.0F, -3.0F, 2.0F}));
    EXPECT_EQ(values_of(sofa->ListenerPosition),
              (std::vector<float>{4.0F, -6.0F, 5.0F, -4.0F, -0.5F, 1.0F}));
    std::string convention;
    for (const MYSOFA_ATTRIBUTE* entry = sofa->attributes; entry != nullptr; entry = entry->next) {
        if (std::strcmp(entry->name, "SOFAConventions") == 0) {
            convention = entry->value;
        }
    }
    EXPECT_EQ(convention, "SingleRoomSRIR");
    mysofa_free(sofa);
}

// libmysofa refuses a file whose attributes fill a block of its heap to the end.
TEST(RoomSofa, IsReadWhateverItsTitleAndChannels) {
    using propagation::Channels;
    const std::vector<std::pair<Channels, std::size_t>> forms = {{Channels::mono, 1},
                                                                 {Channels::binaural, 2},
                                                                 {Channels::ambisonic, 1},
                                                                 {Channels::ambisonic, 4},
                                                                 {Channels::ambisonic, 9},
                                                                 {Channels::ambisonic, 16},
                                                                 {Channels::ambisonic, 25},
                                                                 {Channels::ambisonic, 36}};
    for (const auto& [kind, channels] : forms) {
        RoomMeasurement measurement;
        measurement.channels.assign(channels, {48000.0, {0.5, 0.25}});
        for (std::size_t size = 0; size < 220; size += size < 33 ? 1 : 7) {
            std::string bytes = encode_room_responses(std::string(size, 'x'), kind, {measurement});
            int fault = MYSOFA_OK;
            MYSOFA_HRTF* sofa = mysofa_load_data(bytes.data(), bytes.size(), &fault);
            ASSERT_NE(sofa, nullptr) << channels << " channels, title of " << size << ": " << fault;
            EXPECT_EQ(sofa->R, channels);
            mysofa_free(sofa);
        }
    }
}

TEST(RoomSofa, TheSameResponsesAreTheSameBytes) {
    EXPECT_EQ(encode_room_responses("hall", propagation::Channels::binaural, two_measurements()),
              encode_room_responses("hall", propagation::Channels::binaural, two_measurements()));
}

}  // namespace
}  // namespace earshot::io
