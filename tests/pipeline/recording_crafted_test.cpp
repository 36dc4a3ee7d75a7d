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

/// Runs Python with h5py; `file` is the recording, opened for writing.
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

/// Each row bends a sound recording in a way that the reader has to refuse.
struct Craft {
  const char* name;
  const char* python;
};

void PrintTo(const Craft& craft, std::ostream* stream) { *stream << craft.name; }

class RecordingCrafted : public ::testing::TestWithParam<Craft> {};

TEST_P(RecordingCrafted, IsRefused) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  ASSERT_NO_THROW(check_file(folder / "a.h5", true));
  ASSERT_EQ(edit(folder, std::string(remake) + GetParam().python), 0);
  try {
    check_file(folder / "a.h5", true);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RecordingCrafted,
    ::testing::Values(
        Craft{"NoSchema", "del file.attrs['schema']"},
        Craft{"AnotherSchema", "file.attrs['schema'] = np.bytes_('touchtrace/recording/2')"},
        Craft{"VariableText", "file.attrs['activity'] = 'wave'"},
        Craft{"BrokenProvenance", "file.attrs['provenance'] = np.bytes_('{\"schema\": 1}')"},
        Craft{"ProvenanceIsNoJson", "file.attrs['provenance'] = np.bytes_('{{{{')"},
        Craft{"NoClips", "del file['clips']"}, Craft{"NoCounts", "del file['glove0/counts']"},
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
        Craft{"AnotherType", "remake('glove0/counts', counts.astype('i4'), **whole)"},
        Craft{"BigEndian", "remake('glove0/counts', counts.astype('>u2'), **whole)"},
        Craft{"AnotherShape",
              "remake('glove0/counts', counts[:, :, :4], chunks=(38, 6, 4), fletcher32=True)"},
        Craft{"NoChunks", "remake('glove0/counts', counts)"},
        Craft{"NoChecksum", "remake('glove0/counts', counts, chunks=counts.shape)"},
        Craft{"ForeignFilter", "remake('glove0/counts', counts, compression='lzf', **whole)"},
        Craft{"ChunksAcrossRows",
              "remake('glove0/counts', counts, chunks=(38, 3, 5), fletcher32=True)"},
        Craft{"MissingChunk",
              "remake('glove0/counts', None, shape=counts.shape, dtype='u2', chunks=(1, 6, 5), "
              "fletcher32=True)"},
        Craft{"HugeClaim",
              "file['glove0/host_time_s'].resize((1 << 40,)); file['glove0/counts'].resize(1 << "
              "40, axis=0)"},
        Craft{"WrongUnits", "file['glove0/host_time_s'].attrs['units'] = np.bytes_('ms')"},
        Craft{"MoreImagesThanTimes",
              "file['camera/color'].resize(file['camera/color'].shape[0] - 1, axis=0)"},
        Craft{"NotFiniteAttribute", "file.attrs['epoch_unix_s'] = np.float64('nan')"},
        Craft{"ClipNumberType", "file['glove0'].attrs['rows'] = np.int64(1 << 40)"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(RecordingReading, AnyRowWiseChunksAndFiltersOfOursAreRead) {
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
    h5::try_in_child("file.h5", read);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    return error.what();
  }
  return {};
}

TEST(RecordingChild, TurnsCrashesAndGreedIntoDataErrors) {
  const h5::LibraryLock lock;
  EXPECT_EQ(fault_in_child([] {}), "");
  EXPECT_NE(fault_in_child([] { std::abort(); }), "");
  EXPECT_NE(fault_in_child([] { *static_cast<volatile int*>(nullptr) = 1; }), "");
  EXPECT_NE(fault_in_child([] { std::vector<char> greedy(std::size_t{1} << 40, 1); }), "");
  EXPECT_EQ(fault_in_child([] { throw data_error("spoilt", "mend it"); }), "spoilt");
}

}  // namespace
}  // namespace touchtrace
