// SPDX-License-Identifier: MIT
#include "earshot/io/metrics.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

struct Fixture {
    propagation::Scene scene;
    MetricsHeader header{.scene = scene, .bands = audio::Bands::octaves()};
    propagation::PairMetrics pair;

    Fixture() {
        scene.sources = {{.name = "s", .node = -1, .position = {}}};
        scene.listeners = {{.name = "l", .node = -1, .position = {}}};
        for (audio::MetricValues* values : {static_cast<audio::MetricValues*>(&pair.expected),
                                            &pair.expected.standard_error,
                                            static_cast<audio::MetricValues*>(&pair.response)}) {
            values->bands.resize(10);
        }
    }

    Json encoded() const { return Json::parse(encode_metrics(header, {pair})); }
};

TEST(EncodeMetrics, ExpectedValuesAreOnTopAndThoseOfTheResponseBelow) {
    Fixture fixture;
    fixture.pair.expected.bands[3].clarity_c80_db = -1.5;
    fixture.pair.expected.standard_error.bands[3].clarity_c80_db = 0.25;
    fixture.pair.expected.mid.reverberation_time_t30 = 1.25;
    fixture.pair.expected.standard_error.mid.reverberation_time_t30 = 0.01;
    fixture.pair.expected.speech_transmission_index = 0.61;
    fixture.pair.response.bands[4].early_decay_time = 0.7;
    fixture.pair.response.speech_transmission_index = 0.41;
    fixture.pair.schroeder_hz = 100.0;
    const Json json = fixture.encoded();
    EXPECT_EQ(json["version"], 2);
    EXPECT_EQ(json["bands_hz"][0], 31.5);
    const Json& read = json["pairs"][0];
    EXPECT_EQ(read["source"], "s");
    EXPECT_EQ(read["listener"], "l");
    EXPECT_EQ(read["time"], 0.0);
    EXPECT_EQ(read["c80"].size(), 10U);
    EXPECT_EQ(read["c80"][3], -1.5);
    EXPECT_EQ(read["standard_error"]["c80"][3], 0.25);
    EXPECT_EQ(read["single"]["t30_mid"], 1.25);
    EXPECT_EQ(read["standard_error"]["single"]["t30_mid"], 0.01);
    EXPECT_EQ(read["sti"], 0.61);
    EXPECT_EQ(read["sti_letter"], "D");
    EXPECT_EQ(read["response"]["edt"][4], 0.7);
    EXPECT_EQ(read["response"]["sti_letter"], "I");
    EXPECT_EQ(read["schroeder_hz"], 100.0);
}

TEST(EncodeMetrics, WhatIsNotSupportedIsNull) {
    const Json json = Fixture().encoded();
    const Json& read = json["pairs"][0];
    EXPECT_TRUE(json["room"].is_null());
    EXPECT_FALSE(json.contains("noise"));
    EXPECT_FALSE(json.contains("speech_level"));
    for (const char* key : {"edt", "t20", "t30", "c50", "c80", "d50", "ts", "g"}) {
        EXPECT_TRUE(read[key][2].is_null()) << key;
        EXPECT_TRUE(read["standard_error"][key][2].is_null()) << key;
        EXPECT_TRUE(read["response"][key][2].is_null()) << key;
        EXPECT_TRUE(read["single"][std::string(key) + "_mid"].is_null()) << key;
    }
    EXPECT_TRUE(read["sti"].is_null());
    EXPECT_TRUE(read["sti_letter"].is_null());
    EXPECT_TRUE(read["schroeder_hz"].is_null());
    EXPECT_EQ(read["notes"], Json::array());
    EXPECT_EQ(read["response"]["notes"], Json::array());
}

TEST(EncodeMetrics, NotesSayWhichMetricAndBandTheyAreOf) {
    Fixture fixture;
    fixture.pair.expected.notes = {{"t20", 63.0, "short"}, {"sti", {}, "quiet"}};
    fixture.pair.response.notes = {{"c80", 8000.0, "of the response"}};
    fixture.pair.lateral = {.lateral_fraction = {0.25}, .notes = {{"lf", 125.0, "silent"}}};
    const Json json = fixture.encoded();
    const Json& read = json["pairs"][0];
    EXPECT_EQ(read["notes"], Json::parse(R"([{"metric": "t20", "band_hz": 63.0, "text": "short"},
                              {"metric": "sti", "band_hz": null, "text": "quiet"},
                              {"metric": "lf", "band_hz": 125.0, "text": "silent"}])"));
    EXPECT_EQ(read["response"]["notes"][0]["text"], "of the response");
    EXPECT_EQ(read["lf"][0], 0.25);
}

TEST(EncodeMetrics, HoldTheRoomAndTheConditionsOfSpeech) {
    Fixture fixture;
    propagation::RoomStatistics room = {.volume = 187.0, .surface = 214.0};
    room.sabine.fill(0.8);
    room.eyring.fill(std::numeric_limits<double>::infinity());  // nothing absorbs
    fixture.header.room = room;
    fixture.header.speech = {.speech_level_db = 66.0,
                             .noise_db = audio::SpeechSpectrum{48, 41, 35, 31, 29, 28, 27}};
    const Json json = fixture.encoded();
    EXPECT_EQ(json["room"]["volume"], 187.0);
    EXPECT_EQ(json["room"]["surface"], 214.0);
    EXPECT_EQ(json["room"]["sabine"].size(), 10U);
    EXPECT_EQ(json["room"]["sabine"][9], 0.8);
    EXPECT_TRUE(json["room"]["eyring"][0].is_null());
    EXPECT_EQ(json["speech_level"], 66.0);
    EXPECT_EQ(json["noise"], Json({48.0, 41.0, 35.0, 31.0, 29.0, 28.0, 27.0}));
    fixture.header.speech->noise_db.reset();
    EXPECT_TRUE(fixture.encoded()["noise"].is_null());
}

TEST(EncodeSoundMetrics, HaveTheKeysOfAPairForEachChannel) {
    audio::RoomMetrics channel;
    channel.bands.resize(10);
    channel.bands[5].strength_db = 3.0;
    channel.mid.centre_time = 0.1;
    channel.speech_transmission_index = 0.8;
    channel.notes = {{"t30", 500.0, "noise"}};
    const SoundMetrics sound = {.file = "f.wav",
                                .sample_rate = 8000.0,
                                .channels = {{.channel = 2, .metrics = channel, .onset = 0.25}}};
    const Json json =
        Json::parse(encode_sound_metrics(audio::Bands::octaves(), std::span(&sound, 1)));
    EXPECT_EQ(json["version"], 2);
    EXPECT_EQ(json["file"], "f.wav");
    EXPECT_EQ(json["sample_rate"], 8000.0);
    const Json& read = json["channels"][0];
    EXPECT_EQ(read["channel"], 2);
    EXPECT_EQ(read["g"][5], 3.0);
    EXPECT_EQ(read["single"]["ts_mid"], 0.1);
    EXPECT_EQ(read["sti_letter"], "A+");
    EXPECT_EQ(read["notes"][0]["band_hz"], 500.0);
    EXPECT_FALSE(read.contains("standard_error"));
}

}  // namespace
}  // namespace earshot::io
