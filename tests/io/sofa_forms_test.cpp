// SPDX-License-Identifier: MIT
// One head in every form that AES69 allows is read as one head; what it does not allow is refused
// with the reason.
#include "earshot/base/error.h"
#include "earshot/io/sofa.h"

#include <gtest/gtest.h>

#include "support/sofa_builder.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>

namespace earshot::io {
namespace {

using test::SofaBuilder;
using test::SofaBuilderVariable;
using test::SyntheticHead;
using Values = std::vector<double>;

constexpr hsize_t kAll = SyntheticHead::kMeasurements;
constexpr double kDegree = std::numbers::pi / 180.0;

struct Form {
    const char* name;
    std::function<void(SofaBuilder&)> change;
    double tolerance = 1e-12;  // of a direction and a distance
    double left_delay = 0.0, right_delay = 0.0;
};

// Every vector of `values`, changed.
template <typename Function>
Values for_each_vector(const Values& values, const Function& function) {
    Values result;
    for (std::size_t i = 0; i < values.size(); i += 3) {
        const Values vector = function(values[i], values[i + 1], values[i + 2]);
        result.insert(result.end(), vector.begin(), vector.end());
    }
    return result;
}

void make_sources_cartesian(SofaBuilder& file) {
    SofaBuilderVariable& sources = file.variables["SourcePosition"];
    sources.attributes = {{"Type", "cartesian"}, {"Units", "metre"}};
    sources.values.clear();
    for (std::size_t m = 0; m < kAll; ++m) {
        for (const double component : SyntheticHead::towards(m)) {
            sources.values.push_back(1.4 * component);
        }
    }
}

void swap_ears(Values& values, std::size_t size) {
    for (std::size_t begin = 0; begin < values.size(); begin += 2 * size) {
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
        std::swap_ranges(first,
                         first + static_cast<std::ptrdiff_t>(size),
                         first + static_cast<std::ptrdiff_t>(size));
    }
}

// FreeFieldHRIR: one measurement, an emitter per direction. `is_last`: M R N E, else M R E N.
void make_emitters(SofaBuilder& file, bool is_last) {
    file.attributes["DataType"] = is_last ? "FIR-E" : "FIRE";
    SofaBuilderVariable& samples = file.variables["Data.IR"];
    const Values before = samples.values;
    constexpr hsize_t kLength = SyntheticHead::kLength;
    samples.shape = {1, 2, is_last ? kLength : kAll, is_last ? kAll : kLength};
    for (std::size_t m = 0; m < kAll; ++m) {
        for (std::size_t r = 0; r < 2; ++r) {
            for (std::size_t n = 0; n < kLength; ++n) {
                samples
                    .values[is_last ? (r * kLength + n) * kAll + m : (r * kAll + m) * kLength + n] =
                    before[(m * 2 + r) * kLength + n];
            }
        }
    }
    SofaBuilderVariable& sources = file.variables["SourcePosition"];
    file.variables["EmitterPosition"] = sources;
    file.variables["EmitterPosition"].shape = {kAll, 3, 1};
    sources.shape = {1, 3};
    sources.values = {0.0, 0.0, 0.0};
}

const std::vector<Form>& lawful_forms() {
    static const std::vector<Form> forms = {
        {"plain", [](SofaBuilder&) {}},
        {"RoomType a sentence",
         [](SofaBuilder& file) {
             file.attributes["RoomType"] = "Reverberant - an acoustically treated room.";
         }},
        {"right ear first",
         [](SofaBuilder& file) {
             file.variables["ReceiverPosition"].values = {0.0, -0.09, 0.0, 0.0, 0.09, 0.0};
             swap_ears(file.variables["Data.IR"].values, SyntheticHead::kLength);
         }},
        {"ears in spherical coordinates",
         [](SofaBuilder& file) {
             file.variables["ReceiverPosition"] = {
                 {2, 3},
                 {90.0, 0.0, 0.09, 270.0, 0.0, 0.09},
                 {{"Type", "spherical"}, {"Units", "degree, degree, metre"}}};
         }},
        {"ears per measurement",
         [](SofaBuilder& file) {
             SofaBuilderVariable& ears = file.variables["ReceiverPosition"];
             ears.shape = {2, 3, kAll};
             const Values before = ears.values;
             ears.values.clear();
             for (const double value : before) {
                 ears.values.insert(ears.values.end(), kAll, value);
             }
         }},
        {"sample rate per measurement",
         [](SofaBuilder& file) {
             file.variables["Data.SamplingRate"].shape = {kAll};
             file.variables["Data.SamplingRate"].values = Values(kAll, 48000.0);
         }},
        {"listener looks along +y",
         [](SofaBuilder& file) {
             file.variables["ListenerView"].values = {0.0, 1.0, 0.0};
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double azimuth, double elevation, double r) {
                 return Values{azimuth + 90.0, elevation, r};
             });
         }},
        {"listener's view spherical and of another length",
         [](SofaBuilder& file) {
             const std::map<std::string, std::string> spherical = {
                 {"Type", "spherical"}, {"Units", "degree, degree, metre"}};
             file.variables["ListenerView"] = {{1, 3}, {30.0, 0.0, 2.0}, spherical};
             file.variables["ListenerUp"] = {{1, 3}, {0.0, 90.0, 0.5}, {}};
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double azimuth, double elevation, double r) {
                 return Values{azimuth + 30.0, elevation, r};
             });
         }},
        {"listener lies on the right side",
         [](SofaBuilder& file) {
             make_sources_cartesian(file);
             file.variables["ListenerUp"].values = {0.0, -1.0, 0.0};
             // Front stays, left is up, up is -y.
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double front, double left, double up) {
                 return Values{front, -up, left};
             });
         }},
        {"listener away from the origin",
         [](SofaBuilder& file) {
             make_sources_cartesian(file);
             file.variables["ListenerPosition"].values = {1.0, -2.0, 3.0};
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double x, double y, double z) {
                 return Values{x + 1, y - 2, z + 3};
             });
         }},
        {"listener turns, source rests",
         [](SofaBuilder& file) {
             // The elevated half would need the head to tilt: view and up per measurement.
             file.variables["SourcePosition"] = {
                 {1, 3}, {1.4, 0.0, 0.0}, {{"Type", "cartesian"}, {"Units", "metre"}}};
             Values view, up;
             for (std::size_t m = 0; m < kAll; ++m) {
                 // The x axis in the axes of a head that looks along x: rows of the rotation.
                 const double a = SyntheticHead::azimuth_deg(m) * kDegree;
                 const double e = SyntheticHead::elevation_deg(m) * kDegree;
                 view.insert(view.end(),
                             {std::cos(e) * std::cos(a), -std::sin(a), -std::sin(e) * std::cos(a)});
                 up.insert(up.end(), {std::sin(e), 0.0, std::cos(e)});
             }
             file.variables["ListenerView"].shape = {kAll, 3};
             file.variables["ListenerView"].values = view;
             file.variables["ListenerUp"].shape = {kAll, 3};
             file.variables["ListenerUp"].values = up;
         }},
        {"no view and no up",
         [](SofaBuilder& file) {
             file.variables.erase("ListenerView");
             file.variables.erase("ListenerUp");
         }},
        {"delays of the receivers",
         [](SofaBuilder& file) {
             file.variables["Data.Delay"].values = {5.0, 7.0};
         },
         1e-12,
         5.0,
         7.0},
        {"delays of measurements and receivers",
         [](SofaBuilder& file) {
             file.variables["Data.Delay"].shape = {kAll, 2};
             file.variables["Data.Delay"].values.clear();
             for (std::size_t m = 0; m < kAll; ++m) {
                 file.variables["Data.Delay"].values.insert(
                     file.variables["Data.Delay"].values.end(), {3.0, 0.0});
             }
         },
         1e-12,
         3.0,
         0.0},
        {"no delays", [](SofaBuilder& file) { file.variables.erase("Data.Delay"); }},
        {"single precision", [](SofaBuilder& file) { file.type = H5T_IEEE_F32LE; }, 1e-6},
        {"big-endian", [](SofaBuilder& file) { file.type = H5T_IEEE_F64BE; }},
        {"radians",
         [](SofaBuilder& file) {
             SofaBuilderVariable& sources = file.variables["SourcePosition"];
             sources.attributes["Units"] = "radian, radian, metre";
             sources.values =
                 for_each_vector(sources.values, [](double azimuth, double elevation, double r) {
                     return Values{azimuth * kDegree, elevation * kDegree, r};
                 });
         }},
        {"American spelling",
         [](SofaBuilder& file) {
             file.variables["SourcePosition"].attributes["Units"] = "degrees,degrees,meters";
             file.variables["ReceiverPosition"].attributes["Units"] = "meter, meter, meter";
         }},
        {"azimuths down to -180",
         [](SofaBuilder& file) {
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double azimuth, double elevation, double r) {
                 return Values{azimuth > 180.0 ? azimuth - 360.0 : azimuth, elevation, r};
             });
         }},
        {"cartesian sources", make_sources_cartesian},
        {"chunks, shuffle and zlib", [](SofaBuilder& file) { file.is_compressed = true; }},
        {"texts of variable length", [](SofaBuilder& file) { file.has_variable_texts = true; }},
        {"superblock of version 0", [](SofaBuilder& file) { file.is_earliest_format = true; }},
        {"loudspeaker off its stand",
         [](SofaBuilder& file) {
             make_sources_cartesian(file);
             file.variables["SourceView"] = {
                 {1, 3}, {0.0, -1.0, 0.0}, {{"Type", "cartesian"}, {"Units", "metre"}}};
             file.variables["SourceUp"] = {{1, 3}, {0.0, 0.0, 1.0}, {}};
             // The source looks along -y: its emitter 0.1 m before and 0.2 m above it.
             file.variables["EmitterPosition"].values = {0.1, 0.0, 0.2};
             Values& sources = file.variables["SourcePosition"].values;
             sources = for_each_vector(sources, [](double x, double y, double z) {
                 return Values{x, y + 0.1, z - 0.2};
             });
         }},
        {"GeneralFIR",
         [](SofaBuilder& file) { file.attributes["SOFAConventions"] = "GeneralFIR"; }},
        {"FreeFieldHRIR",
         [](SofaBuilder& file) {
             file.attributes["SOFAConventions"] = "FreeFieldHRIR";
             make_emitters(file, true);
         }},
        {"GeneralFIR-E with a delay per emitter",
         [](SofaBuilder& file) {
             file.attributes["SOFAConventions"] = "GeneralFIR-E";
             make_emitters(file, true);
             file.variables["Data.Delay"] = {{1, 2, kAll}, Values(2 * kAll, 4.0)};
         },
         1e-12,
         4.0,
         4.0},
        {"GeneralFIRE of 2015",
         [](SofaBuilder& file) {
             file.attributes["SOFAConventions"] = "GeneralFIRE";
             make_emitters(file, false);
         }},
    };
    return forms;
}

Values delayed(const Values& samples, double delay, std::size_t size) {
    Values result(size, 0.0);
    std::copy(samples.begin(), samples.end(), result.begin() + static_cast<std::ptrdiff_t>(delay));
    return result;
}

TEST(SofaForms, OfOneHeadAreReadAlike) {
    const test::TemporaryFolder folder;
    for (const Form& form : lawful_forms()) {
        SCOPED_TRACE(form.name);
        SofaBuilder file = test::synthetic_head_file();
        form.change(file);
        file.write(folder.path() / "head.sofa");
        const audio::HrirSet head = read_hrir_set(folder.path() / "head.sofa");
        EXPECT_EQ(head.sample_rate, 48000.0);
        EXPECT_EQ(head.centre_delay, 0.0);
        ASSERT_EQ(head.directions.size(), kAll);
        const std::size_t size = SyntheticHead::kLength + static_cast<std::size_t>(std::max(
                                                              form.left_delay, form.right_delay));
        for (std::size_t m = 0; m < kAll; ++m) {
            const audio::Hrir& hrir = head.directions[m];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(hrir.towards[axis], SyntheticHead::towards(m)[axis], form.tolerance)
                    << "measurement " << m << ", axis " << axis;
            }
            ASSERT_NEAR(hrir.distance, 1.4, form.tolerance);
            ASSERT_EQ(hrir.left, delayed(SyntheticHead::response(m, 1.0), form.left_delay, size));
            ASSERT_EQ(hrir.right,
                      delayed(SyntheticHead::response(m, -1.0), form.right_delay, size));
        }
    }
    EXPECT_GE(lawful_forms().size(), 15U);
}

// An interpolated delay has the spectrum of the response, turned by the delay.
TEST(SofaForms, DelaysBetweenSamplesAreInterpolated) {
    const test::TemporaryFolder folder;
    SofaBuilder file = test::synthetic_head_file();
    file.variables["Data.Delay"].values = {100.25, 100.0};
    file.write(folder.path() / "head.sofa");
    const audio::HrirSet head = read_hrir_set(folder.path() / "head.sofa");
    const auto spectrum = [](const Values& samples, double omega) {
        std::complex<double> sum = 0.0;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            sum += std::polar(samples[n], -omega * static_cast<double>(n));
        }
        return sum;
    };
    for (const double omega : {0.1, 1.0, 2.0, 2.9}) {
        const auto expected =
            spectrum(SyntheticHead::response(3, 1.0), omega) * std::polar(1.0, -100.25 * omega);
        EXPECT_LT(std::abs(spectrum(head.directions[3].left, omega) - expected), 1e-4) << omega;
    }
    EXPECT_EQ(head.directions[3].left.size(), head.directions[3].right.size());
}

TEST(SofaForms, DistancesAreKept) {
    const test::TemporaryFolder folder;
    SofaBuilder file = test::synthetic_head_file();
    Values& sources = file.variables["SourcePosition"].values;
    for (std::size_t m = 0; m < kAll; ++m) {
        sources[3 * m] = 30.0 * static_cast<double>(m / 4);
        sources[3 * m + 1] = 0.0;
        sources[3 * m + 2] = std::array{0.2, 0.5, 1.0, 2.0}[m % 4];
    }
    file.write(folder.path() / "head.sofa");
    const audio::HrirSet head = read_hrir_set(folder.path() / "head.sofa");
    ASSERT_EQ(head.directions.size(), kAll);
    for (std::size_t m = 0; m < kAll; ++m) {
        EXPECT_NEAR(head.directions[m].distance, sources[3 * m + 2], 1e-12);
        EXPECT_EQ(head.directions[m].left, SyntheticHead::response(m, 1.0));
    }
}

// Half of the measurements at half the rate: their transfer functions stay, in hertz.
TEST(SofaForms, UnequalSampleRatesAreRaisedToTheHighest) {
    const test::TemporaryFolder folder;
    SofaBuilder file = test::synthetic_head_file();
    file.variables["Data.SamplingRate"].shape = {kAll};
    file.variables["Data.SamplingRate"].values = Values(kAll, 48000.0);
    file.variables["Data.SamplingRate"].values[5] = 24000.0;
    // Smooth, so that nothing lies beyond the lower rate.
    Values& samples = file.variables["Data.IR"].values;
    const auto bell = [](double time) { return std::exp(-0.5 * std::pow(time / 8e-5, 2)); };
    for (std::size_t n = 0; n < SyntheticHead::kLength; ++n) {
        samples[10 * SyntheticHead::kLength + n] =
            bell(static_cast<double>(n) / 24000.0 - 6e-4) * 2.0;
    }
    file.write(folder.path() / "head.sofa");
    const audio::HrirSet head = read_hrir_set(folder.path() / "head.sofa");
    EXPECT_EQ(head.sample_rate, 48000.0);
    ASSERT_EQ(head.directions.size(), kAll);
    EXPECT_EQ(head.directions[4].left, SyntheticHead::response(4, 1.0));
    ASSERT_GT(head.directions[5].left.size(), 60U);
    for (std::size_t n = 0; n < 60; ++n) {
        // Twice the samples, each half as large.
        EXPECT_NEAR(
            head.directions[5].left[n], bell(static_cast<double>(n) / 48000.0 - 6e-4), 1e-3);
    }
}

struct Fault {
    const char* reason;  // a part of the error line
    std::function<void(SofaBuilder&)> change;
};

void expect_refused(const std::filesystem::path& file, const std::string& reason) {
    try {
        read_hrir_set(file);
        ADD_FAILURE() << "read, not refused: " << reason;
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), file.string());
        EXPECT_NE(error.line().find(reason), std::string::npos) << error.line();
        EXPECT_EQ(error.line().find('\n'), std::string::npos);
        EXPECT_FALSE(error.remedy().empty());
    }
}

TEST(SofaForms, WhatIsNoneIsRefusedWithTheReason) {
    const std::vector<Fault> faults = {
        {"no SOFA file", [](SofaBuilder& file) { file.attributes.erase("Conventions"); }},
        {"of the type TF", [](SofaBuilder& file) { file.attributes["DataType"] = "TF"; }},
        {"convention SingleRoomSRIR",
         [](SofaBuilder& file) { file.attributes["SOFAConventions"] = "SingleRoomSRIR"; }},
        {"has no Data.IR", [](SofaBuilder& file) { file.variables.erase("Data.IR"); }},
        {"has no SourcePosition",
         [](SofaBuilder& file) { file.variables.erase("SourcePosition"); }},
        {"of 1 receiver,",
         [](SofaBuilder& file) {
             file.variables["Data.IR"].shape = {kAll, 1, 2 * SyntheticHead::kLength};
         }},
        {"Data.IR does not have the dimensions",
         [](SofaBuilder& file) {
             file.variables["Data.IR"].shape = {kAll, 2 * SyntheticHead::kLength};
         }},
        {"incomplete or not finite",
         [](SofaBuilder& file) {
             file.variables["Data.IR"].values[77] = std::numeric_limits<double>::quiet_NaN();
         }},
        {"incomplete or not finite",
         [](SofaBuilder& file) { file.variables["Data.IR"].values[77] = 9.96920996838687e36; }},
        {"which receiver is the left ear",
         [](SofaBuilder& file) { file.variables["ReceiverPosition"].values = Values(6, 0.0); }},
        {"SourcePosition has the Units \"gon, gon, metre\"",
         [](SofaBuilder& file) {
             file.variables["SourcePosition"].attributes["Units"] = "gon, gon, metre";
         }},
        {"SourcePosition has the Units \"metre\"",
         [](SofaBuilder& file) { file.variables["SourcePosition"].attributes["Units"] = "metre"; }},
        {"SourcePosition has no Type",
         [](SofaBuilder& file) { file.variables["SourcePosition"].attributes.clear(); }},
        {"EmitterPosition as spherical harmonics",
         [](SofaBuilder& file) {
             make_emitters(file, true);
             file.attributes["SOFAConventions"] = "FreeFieldHRIR";
             file.variables["EmitterPosition"].attributes["Type"] = "spherical harmonics";
         }},
        {"measurement 3 has its source where the listener is",
         [](SofaBuilder& file) { file.variables["SourcePosition"].values[8] = 0.0; }},
        {"SourcePosition does not have the dimensions",
         [](SofaBuilder& file) {
             file.variables["SourcePosition"].shape = {kAll / 2, 6};
         }},
        {"ListenerView and ListenerUp",
         [](SofaBuilder& file) {
             file.variables["ListenerUp"].values = {2.0, 0.0, 0.0};
         }},
        {"Data.Delay is not between",
         [](SofaBuilder& file) {
             file.variables["Data.Delay"].values = {-1.0, 0.0};
         }},
        {"Data.Delay is not between",
         [](SofaBuilder& file) {
             file.variables["Data.Delay"].values = {1e9, 0.0};
         }},
        {"sample rate is not between",
         [](SofaBuilder& file) { file.variables["Data.SamplingRate"].values = {0.0}; }},
        {"Data.SamplingRate has the Units \"kilohertz\"",
         [](SofaBuilder& file) {
             file.variables["Data.SamplingRate"].attributes["Units"] = "kilohertz";
         }},
        {"responses too long to resample",
         [](SofaBuilder& file) {
             file.variables["Data.SamplingRate"].shape = {kAll};
             file.variables["Data.SamplingRate"].values = Values(kAll, 768e3);
             file.variables["Data.SamplingRate"].values[3] = 1e3;
             file.variables["Data.Delay"].values = {900.0, 0.0};
         }},
        {"Data.IR in another file", [](SofaBuilder& file) { file.external_file = "/dev/null"; }},
        {"declared with more than",
         [](SofaBuilder& file) {
             file.is_compressed = true;
             file.variables["Data.Delay"] = {{1U << 17U, 1U << 10U}, {}};
         }},
    };
    const test::TemporaryFolder folder;
    for (const Fault& fault : faults) {
        SCOPED_TRACE(fault.reason);
        SofaBuilder file = test::synthetic_head_file();
        fault.change(file);
        const auto path = folder.path() / "head.sofa";
        file.write(path);
        expect_refused(path, fault.reason);
    }
}

TEST(SofaForms, WhatIsNoHdf5FileIsRefusedWithTheReason) {
    const test::TemporaryFolder folder;
    expect_refused(folder.file("text.sofa", "no HDF5 at all"), "no HDF5 signature");
    expect_refused(folder.file("empty.sofa", ""), "no HDF5 signature");
    expect_refused(folder.path() / "none.sofa", "no such file");
    expect_refused(folder.path(), "is a directory");
    expect_refused("/dev/null", "is not a file");
    expect_refused(folder.file("cut.sofa", "\x89HDF\r\n\x1a\n"), "damaged");
}

}  // namespace
}  // namespace earshot::io
