#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/error.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/h5_file.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::put;
using testing::sample_recording;
using testing::TemporaryFolder;

/// Runs Python code with h5py; `file` is the recording, open for writing.
int edit(const TemporaryFolder& folder, const std::string& python) {
  put(folder / "edit.py", "import h5py, numpy as np\nfile = h5py.File('" +
                              (folder / "a.h5").string() + "', 'r+')\n" + python +
                              "\nfile.close()\n");
  return std::system(("/usr/bin/python3 " + (folder / "edit.py").string()).c_str());
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
  ASSERT_EQ(edit(folder, std::string(remake) + GetParam().python), 0);
  try {
    check_file(folder / "a.h5", true);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data) << error.what();
    EXPECT_NE(std::string(error.what()).find(GetParam().fault), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RecordingCrafted,
    ::testing::Values(
        Craft{"NoSchema", "del file.attrs['schema']", "a.h5: / attribute 'schema': missing"},
        Craft{"AnotherSchema", "file.attrs['schema'] = np.bytes_('touchtrace/recording/2')",
              "expected schema 'touchtrace/recording/1', found 'touchtrace/recording/2'"},
        Craft{"VariableText", "file.attrs['activity'] = 'wave'",
              "/ attribute 'activity': expected text of fixed length, found variable-length text"},
        Craft{"BrokenProvenance", "file.attrs['provenance'] = np.bytes_('{\"schema\": 1}')"},
        Craft{"ProvenanceIsNotJson", "file.attrs['provenance'] = np.bytes_('{{{{')",
              "/ attribute 'provenance': expected JSON"},
        Craft{"NoClips", "del file['clips']", "a.h5: /clips: the group is missing"},
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
        Craft{"AnotherType", "remake('glove0/counts', counts.astype('i4'), **whole)",
              "/glove0/counts: expected type uint16, found int32"},
        Craft{"BigEndian", "remake('glove0/counts', counts.astype('>u2'), **whole)",
              "/glove0/counts: expected type uint16, found big-endian uint16"},
        Craft{"AnotherShape",
              "remake('glove0/counts', counts[:, :, :4], chunks=(38, 6, 4), fletcher32=True)",
              "/glove0/counts: expected shape (38, 6, 5), found (38, 6, 4)"},
        Craft{"NoChunks", "remake('glove0/counts', counts)",
              "/glove0/counts: expected chunked storage"},
        Craft{"NoChecksum", "remake('glove0/counts', counts, chunks=counts.shape)",
              "expected fletcher32 checksums"},
        Craft{"ForeignFilter", "remake('glove0/counts', counts, compression='lzf', **whole)"},
        Craft{"ChunksAcrossRows",
              "remake('glove0/counts', counts, chunks=(38, 3, 5), fletcher32=True)"},
        Craft{"MissingChunk",
              "remake('glove0/counts', None, shape=counts.shape, dtype='u2', chunks=(1, 6, 5), "
              "fletcher32=True)"},
        Craft{"HugeClaim",
              "file['glove0/host_time_s'].resize((1 << 40,)); file['glove0/counts'].resize(1 << "
              "40, axis=0)"},
        Craft{"WrongUnits", "file['glove0/host_time_s'].attrs['units'] = np.bytes_('ms')",
              "/glove0/host_time_s: expected units 's', found 'ms'"},
        Craft{"NoUnits", "del file['glove0/mask'].attrs['units']",
              "/glove0/mask: attribute 'units': missing"},
        Craft{"TimesOfTwoAxes",
              "remake('glove0/host_time_s', np.zeros((38, 2)), 's', chunks=(38, 2), "
              "fletcher32=True)",
              "/glove0/host_time_s: expected shape (any), found (38, 2)"},
        Craft{"MoreImagesThanTimes",
              "file['camera/color'].resize(file['camera/color'].shape[0] - 1, axis=0)",
              "/camera/color: expected"},
        Craft{"NotFiniteAttribute", "file.attrs['epoch_unix_s'] = np.float64('nan')",
              "/ attribute 'epoch_unix_s': expected a finite number, found nan"},
        Craft{"RowsBeyondThirtyTwoBits", "file['glove0'].attrs['rows'] = np.int64(1 << 40)"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(RecordingReading, ListsAllFaultsAndNotTheirConsequences) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  ASSERT_EQ(edit(folder, std::string(remake) + R"(
del file['clips/end_s'], file['glove0'].attrs['rows'], file['glove0/mask'], file['truth/hand']
file['glove0/baseline'].attrs['units'] = np.bytes_('V')
file['camera'].attrs['rate_hz'] = np.int64(20)
remake('camera/sequence', np.zeros(3), chunks=(3,), fletcher32=True)
)"),
            0);
  try {
    check_file(folder / "a.h5", true);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder / "a.h5").string() +
                  ": 7 faults\n"
                  "  /clips/end_s: the dataset is missing\n"
                  "  /glove0 attribute 'rows': missing\n"
                  "  /glove0/baseline: expected units '1', found 'V'\n"
                  "  /glove0/mask: the dataset is missing\n"
                  "  /camera attribute 'rate_hz': expected type float64, found int64\n"
                  "  /camera/sequence: expected type uint64, found float64\n"
                  "  /truth/hand: the group is missing");
  }
}

TEST(RecordingReading, AcceptsOtherChunkSizesAndFilterSubsets) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  ASSERT_EQ(
      edit(folder,
           std::string(remake) +
               "remake('glove0/counts', counts, chunks=(7, 6, 5), shuffle=True, compression=9, "
               "fletcher32=True)\n"
               "remake('glove0/sequence', file['glove0/sequence'][:], chunks=(5,), "
               "fletcher32=True)"),
      0);
  const RecordingReader reader(folder / "a.h5");
  EXPECT_EQ(reader.recording().gloves[0].counts, sample.recording.gloves[0].counts);
  EXPECT_EQ(reader.recording().gloves[0].sequence, sample.recording.gloves[0].sequence);
}

std::string fault_in_child(const std::function<void()>& read) {
  try {
    h5::run_in_child("file.h5", read);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    return error.what();
  }
  return {};
}

TEST(RecordingChild, TurnsCrashesAndMemoryLimitIntoDataErrors) {
  const h5::LibraryLock lock;
  EXPECT_EQ(fault_in_child([] {}), "");
  EXPECT_NE(fault_in_child([] { std::abort(); }), "");
  EXPECT_NE(fault_in_child([] { *static_cast<volatile int*>(nullptr) = 1; }), "");
  EXPECT_NE(fault_in_child([] { std::vector<char> large(std::size_t{1} << 40, 1); }), "");
  EXPECT_EQ(fault_in_child([] { throw data_error("damaged", "hint"); }), "damaged");
}

}  // namespace
}  // namespace touchtrace
