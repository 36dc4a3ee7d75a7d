#include <gtest/gtest.h>

#include <cstdlib>

#include "pipeline/recording/check.h"
#include "pipeline/recording/h5_file.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::sample_recording;
using testing::TemporaryFolder;

/// Runs Python code; `file` is the recording, open for writing.
void edit(const TemporaryFolder& folder, const std::string& python) {
  testing::expect_python(folder.path(),
                         "file = h5py.File('a.h5', 'r+')\n" + python + "\nfile.close()");
}

constexpr const char* remake = R"(
def remake(name, data, units='1', **how):
    del file[name]
    file.create_dataset(name, data=data, **how).attrs['units'] = np.bytes_(units)
counts = file['glove0/counts'][:]
whole = dict(chunks=counts.shape, fletcher32=True)
)";

/// Change to a valid recording that the reader must reject.
struct Craft {
  const char* name;
  const char* python;
  const char* fault = "";  ///< part of the message
};

void PrintTo(const Craft& craft, std::ostream* stream) { *stream << craft.name; }

class RecordingCrafted : public ::testing::TestWithParam<Craft> {};

TEST_P(RecordingCrafted, IsRejected) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  ASSERT_NO_THROW(check_file(folder / "a.h5", true));
  edit(folder, std::string(remake) + GetParam().python);
  testing::expect_error([&] { check_file(folder / "a.h5", true); }, GetParam().fault);
}

INSTANTIATE_TEST_SUITE_P(
    Files, RecordingCrafted,
    ::testing::Values(
        Craft{"NoSchema", "del file.attrs['schema']", "a.h5: / attribute 'schema': missing"},
        Craft{"AnotherSchema", "file.attrs['schema'] = np.bytes_('touchtrace/recording/3')",
              "expected schema 'touchtrace/recording/2' or 'touchtrace/recording/1', found "
              "'touchtrace/recording/3'"},
        Craft{"NumberForText", "file.attrs['activity'] = 3",
              "/ attribute 'activity': expected text, found int64"},
        Craft{"TextForNumber", "file['color'].attrs['rate_hz'] = 'fast'",
              "/color attribute 'rate_hz': expected numbers, found \"fast\""},
        Craft{"BrokenProvenance", "file.attrs['provenance'] = np.bytes_('{\"schema\": 1}')"},
        Craft{"ProvenanceIsNotJson", "file.attrs['provenance'] = np.bytes_('{{{{')",
              "/ attribute 'provenance': expected JSON"},
        Craft{"NoCounts", "del file['glove0/counts']", "/glove0/counts: the dataset is missing"},
        Craft{"ExternalLink",
              "del file['clips']; file['clips'] = h5py.ExternalLink('b.h5', '/clips')"},
        Craft{"SoftLink", "file.move('clips', 'c'); file['clips'] = h5py.SoftLink('/c')"},
        Craft{"GroupForDataset", "del file['glove0/counts']; file.create_group('glove0/counts')"},
        Craft{"ExternalStorage",
              "remake('glove0/counts', None, shape=counts.shape, dtype='u2', "
              "external=[('/etc/passwd', 0, h5py.h5f.UNLIMITED)])"},
        Craft{
            "VirtualDataset",
            "layout = h5py.VirtualLayout(counts.shape, 'u2')\n"
            "layout[:] = h5py.VirtualSource('b.h5', 'x', counts.shape)\n"
            "del file['glove0/counts']\n"
            "file.create_virtual_dataset('glove0/counts', layout).attrs['units'] = np.bytes_('1')"},
        Craft{"VariableLength",
              "remake('glove0/counts', None, shape=(38,), dtype=h5py.vlen_dtype('u2'), "
              "chunks=(38,))"},
        Craft{"NegativeCounts", "remake('glove0/counts', counts.astype('i4') - 9999)",
              "/glove0/counts: expected whole numbers from 0 to 65535, found -"},
        Craft{"FractionsOfPixels", "remake('clips/hand_box', np.full((2, 4), 0.5))",
              "/clips/hand_box: expected whole numbers from -2147483648 to 2147483647, found 0.5"},
        Craft{"ComplexNumbers", "remake('glove0/baseline', np.zeros((6, 5), complex))",
              "/glove0/baseline: expected integers or floats of 32 or 64 bits, found another type"},
        Craft{"AnotherShape",
              "remake('glove0/counts', counts[:, :, :4], chunks=(38, 6, 4), fletcher32=True)",
              "/glove0/counts: expected shape (38, 6, 5), found (38, 6, 4)"},
        Craft{"ForeignFilter", "remake('glove0/counts', counts, compression='lzf', **whole)",
              "found 'lzf' (32000)"},
        Craft{"NeverWritten", "remake('glove0/counts', None, shape=counts.shape, dtype='u2')",
              "/glove0/counts: expected values, found none"},
        Craft{"MissingChunk",
              "remake('glove0/counts', None, shape=counts.shape, dtype='u2', chunks=(1, 6, 5), "
              "fletcher32=True)"},
        Craft{"HugeClaim",
              "file['glove0/host_time_s'].resize((1 << 40,)); file['glove0/counts'].resize(1 << "
              "40, axis=0)"},
        Craft{"WrongUnits", "file['glove0/host_time_s'].attrs['units'] = np.bytes_('ms')",
              "/glove0/host_time_s: expected units 's', found 'ms'"},
        Craft{"TimesOfTwoAxes",
              "remake('glove0/host_time_s', np.zeros((38, 2)), 's', chunks=(38, 2), "
              "fletcher32=True)",
              "/glove0/host_time_s: expected shape (any), found (38, 2)"},
        Craft{"MoreImagesThanTimes",
              "file['color/image'].resize(file['color/image'].shape[0] - 1, axis=0)",
              "/color/image: expected shape (54, 6, 8, 3), found (53, 6, 8, 3)"},
        Craft{"ImagesWithoutTimes", "del file['depth/host_time_s']",
              "/depth/host_time_s: the dataset is missing"},
        Craft{"TimesWithoutImages", "del file['depth/image']",
              "/depth/image: the dataset is missing"},
        Craft{"GreyImages", "remake('color/image', file['color/image'][..., 0])",
              "/color/image: expected shape (54, "},
        Craft{"NoDepthUnit", "del file['depth'].attrs['depth_unit_m']",
              "/depth attribute 'depth_unit_m': missing"},
        Craft{"UnknownLens", "file['depth'].attrs['distortion_model'] = 'Brown Conrady'",
              "/depth attribute 'distortion_model': expected plumb_bob"},
        Craft{"IntrinsicsMatrix", "file['depth'].attrs['intrinsics'] = np.eye(3)",
              "/depth attribute 'intrinsics': expected length 4, found 9"},
        Craft{"PoseInMillimetres",
              "file['depth'].attrs['depth_from_color'] = np.eye(4) + 50 * np.eye(4, k=3)",
              "/depth attribute 'depth_from_color': expected a rotation and a translation [m]"},
        Craft{"MaskOfNoImage", "file['masks/color_frame'][0] = 54",
              "/masks/color_frame: expected indices of the 54 colour images, found 54"},
        Craft{"MaskOfAnotherSize", "remake('masks/image', np.zeros((1, 8, 6), 'u1'))",
              "/masks/image: expected shape (any, 6, 8), found (1, 8, 6)"},
        Craft{"BoxFrameOfNoImage", "file['clips/box_frame'][0] = 54",
              "/clips/box_frame: expected an index of the 54 colour images, found 54"},
        Craft{"NegativeRows", "file['glove0'].attrs['rows'] = -3",
              "/glove0 attribute 'rows': expected 1 to 4096, found -3"},
        Craft{"HugeGapOfTheCounter", "file['glove0/sequence'][37] = 1 << 40",
              "/glove0/sequence: expected at most 100000000 frames"},
        Craft{"ClipsOfAnotherClock", "file['clips/end_s'][1] = 1.7e9",
              "/clips, clip 1: expected times of the streams' clock"},
        Craft{"NotFiniteAttribute", "file.attrs['epoch_unix_s'] = np.float64('nan')",
              "/ attribute 'epoch_unix_s': expected a finite number, found nan"},
        Craft{"RowsBeyondThirtyTwoBits", "file['glove0'].attrs['rows'] = np.int64(1 << 40)"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(RecordingReading, ListsAllFaultsAndNotTheirConsequences) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  edit(folder, std::string(remake) + R"(
remake('clips/end_s', np.ones(3), 's')
del file['glove0/counts'], file['truth/hand']
file['glove0/baseline'].attrs['units'] = np.bytes_('V')
file['depth'].attrs['rate_hz'] = [1, 2]
remake('color/sequence', np.zeros(3))
file['glove0/host_time_s'][3] = np.nan
)");
  testing::expect_error([&] { check_file(folder / "a.h5", true); },
                        (folder / "a.h5").string() +
                            ": 7 faults\n"
                            "  /glove0/counts: the dataset is missing\n"
                            "  /glove0/baseline: expected units '1', found 'V'\n"
                            "  /depth attribute 'rate_hz': expected length 1, found 2\n"
                            "  /color/sequence: expected shape (54), found (3)\n"
                            "  /clips/end_s: expected shape (2), found (3)\n"
                            "  /glove0/host_time_s: expected finite values, found nan at index 3\n"
                            "  /truth/hand: the group is missing; ");
}

/// Storage that h5py's users choose, of the same counts.
class StoredCounts : public ::testing::TestWithParam<const char*> {};

TEST_P(StoredCounts, AreReadExactly) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  edit(folder, std::string(remake) + "remake('glove0/counts', " + GetParam() + ")");
  EXPECT_EQ(RecordingReader(folder / "a.h5").recording().gloves[0].counts,
            sample.recording.gloves[0].counts);
}

INSTANTIATE_TEST_SUITE_P(
    Files, StoredCounts,
    ::testing::Values("counts", "counts, chunks=(7, 6, 5)", "counts, compression='gzip'",
                      "counts, chunks=(7, 6, 5), shuffle=True, compression=9, fletcher32=True",
                      "counts, chunks=(5, 4, 3), shuffle=True, compression='gzip'",
                      "counts, chunks=(38, 3, 5), fletcher32=True", "counts, chunks=True",
                      "counts, chunks=(50, 10, 10), maxshape=(None, None, None)",
                      "counts.astype('>u2')", "counts.astype('i8')", "counts.astype('>i4')",
                      "counts.astype('f4'), chunks=(5, 4, 3)", "counts.astype('>f8')"),
    [](const auto& instance) { return "Storage" + std::to_string(instance.index); });

void expect_fault_in_child(const std::function<void()>& read, const std::string& fault) {
  testing::expect_error([&] { h5::run_in_child("file.h5", read); }, fault);
}

TEST(RecordingChild, TurnsCrashesAndMemoryLimitIntoDataErrors) {
  const h5::LibraryLock lock;
  EXPECT_NO_THROW(h5::run_in_child("file.h5", [] {}));
  expect_fault_in_child([] { std::abort(); }, "");
  expect_fault_in_child([] { *static_cast<volatile int*>(nullptr) = 1; }, "");
  expect_fault_in_child([] { std::vector<char> large(std::size_t{1} << 40, 1); }, "");
  expect_fault_in_child([] { throw data_error("damaged", "hint"); }, "damaged; hint");
}

}  // namespace
}  // namespace touchtrace
