// Generated files on disk: whole, unchanged when the same, and none left over from an earlier run.
#include "backend/output_files.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "commands/json.hpp"
#include "diagnostics.hpp"

namespace dalembert {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public testing::Test {
 protected:
  OutputFiles() {
    std::string pattern = (fs::temp_directory_path() / "dalembert_test.XXXXXX").string();
    root_ = mkdtemp(pattern.data());
  }
  ~OutputFiles() override { fs::remove_all(root_); }

  std::string text(const std::string& name) const {
    std::ifstream file(root_ / "out" / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  size_t count() const { return static_cast<size_t>(std::distance(fs::directory_iterator(root_ / "out"), {})); }
  void write(const std::vector<backend::OutputFile>& files) { backend::write_files((root_ / "out").string(), files); }

  fs::path root_;
};

const std::string ours = std::string("// ") + backend::banner_mark + " from r.urdf\n";

TEST_F(OutputFiles, AreAddedBesideOnesOfAnEarlierRun) {
  write({{"a.hpp", ours}});
  backend::add_files((root_ / "out").string(), {{"b.csv", "1"}});
  EXPECT_EQ(count(), 2u);
  EXPECT_EQ(text("a.hpp"), ours);
  EXPECT_EQ(text("b.csv"), "1");
}

TEST_F(OutputFiles, AreWrittenAndNothingElseIs) {
  write({{"a.hpp", ours + "1"}, {"b.cpp", std::string("x\0y\n", 4)}});
  EXPECT_EQ(text("a.hpp"), ours + "1");
  EXPECT_EQ(text("b.cpp"), std::string("x\0y\n", 4));
  EXPECT_EQ(count(), 2u);
}

TEST_F(OutputFiles, OfFoldersWithinAreWrittenTogetherOrNotAtAll) {
  write({{"a.hpp", ours}, {"code/b.hpp", ours}, {"code/tasks.cpp", ours}});
  EXPECT_EQ(text("code/b.hpp"), ours);
  write({{"a.hpp", ours + "1"}, {"code/b.hpp", ours + "1"}});
  EXPECT_EQ(text("code/b.hpp"), ours + "1");
  EXPECT_FALSE(fs::exists(root_ / "out/code/tasks.cpp")) << "it would be compiled with the others";
  std::ofstream(root_ / "out/c.txt") << "the user's";
  EXPECT_THROW(write({{"code/b.hpp", ours + "2"}, {"code/d.hpp", ours}, {"c.txt", ours}}), InputError);
  EXPECT_EQ(text("code/b.hpp"), ours + "1");
  EXPECT_EQ(text("c.txt"), "the user's");
  EXPECT_FALSE(fs::exists(root_ / "out/code/d.hpp"));
}

TEST_F(OutputFiles, AreLeftAloneWhenTheyStayTheSame) {
  write({{"a.hpp", ours + "1"}, {"b.hpp", ours + "1"}});
  const fs::file_time_type old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(root_ / "out/a.hpp", old);
  fs::last_write_time(root_ / "out/b.hpp", old);
  write({{"a.hpp", ours + "1"}, {"b.hpp", ours + "12"}});
  EXPECT_EQ(fs::last_write_time(root_ / "out/a.hpp"), old);
  EXPECT_NE(fs::last_write_time(root_ / "out/b.hpp"), old);
  EXPECT_EQ(text("b.hpp"), ours + "12");
}

TEST_F(OutputFiles, BehindALinkAreWrittenAndKeepTheirPermissions) {
  write({{"a.hpp", ours}});
  fs::rename(root_ / "out/a.hpp", root_ / "kept.hpp");
  fs::create_symlink("../kept.hpp", root_ / "out/a.hpp");
  fs::permissions(root_ / "kept.hpp", fs::perms(0640));
  write({{"a.hpp", ours + "1"}});
  EXPECT_TRUE(fs::is_symlink(root_ / "out/a.hpp"));
  EXPECT_EQ(text("a.hpp"), ours + "1");
  EXPECT_EQ(fs::status(root_ / "kept.hpp").permissions(), fs::perms(0640));
  fs::remove(root_ / "kept.hpp");
  EXPECT_THROW(write({{"a.hpp", ours + "2"}}), InputError);
  EXPECT_TRUE(fs::is_symlink(root_ / "out/a.hpp"));
}

TEST_F(OutputFiles, OfAnEarlierRunAreRemovedAndForeignOnesKept) {
  write({{"a.hpp", ours}, {"tasks.hpp", ours}});
  std::ofstream(root_ / "out/mine.txt") << "mine";
  fs::copy_file(root_ / "out/a.hpp", root_ / "out/my_a.hpp");
  fs::create_directory(root_ / "out/folder");
  write({{"a.hpp", ours}});
  EXPECT_FALSE(fs::exists(root_ / "out/tasks.hpp"));
  EXPECT_EQ(text("mine.txt"), "mine");
  EXPECT_EQ(text("my_a.hpp"), ours);
  std::ofstream(root_ / "out/tasks.hpp") << "mine";
  write({{"a.hpp", ours}});
  EXPECT_EQ(text("tasks.hpp"), "mine");
  EXPECT_TRUE(fs::is_directory(root_ / "out/folder"));
}

TEST_F(OutputFiles, DoNotTakeThePlaceOfForeignOnes) {
  write({{"a.hpp", ours}});
  std::ofstream(root_ / "out/b.hpp") << "mine";
  EXPECT_THROW(write({{"a.hpp", ours + "1"}, {"b.hpp", ours}}), InputError);
  EXPECT_EQ(text("a.hpp"), ours);  // nothing is written then
  EXPECT_EQ(text("b.hpp"), "mine");
  std::ofstream(root_ / "out/b.hpp", std::ios::trunc).close();  // empty: nothing is lost
  write({{"a.hpp", ours + "1"}, {"b.hpp", ours}});
  EXPECT_EQ(text("b.hpp"), ours);
}

TEST_F(OutputFiles, ThatCannotBeWrittenAreRefused) {
  std::ofstream(root_ / "out") << "a file";
  EXPECT_THROW(write({{"a.hpp", ours}}), InputError);
  fs::remove(root_ / "out");
  fs::create_directories(root_ / "out/a.hpp/inside");  // a folder in the file's place
  EXPECT_THROW(write({{"0.hpp", ours}, {"a.hpp", ours}, {"b.hpp", ours}}), InputError);
  EXPECT_EQ(count(), 1u);  // neither the others nor temporary files stay
}

// Of a run that was killed between writing and renaming; what others may be writing stays.
TEST_F(OutputFiles, LeftOverUnderTemporaryNamesAreRemoved) {
  fs::create_directories(root_ / "out");
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  waitpid(gone, nullptr, 0);
  const std::string over = "a.hpp.new" + std::to_string(gone), in_use = "a.hpp.new" + std::to_string(getppid());
  for (const std::string& name : {over, in_use, std::string("a.hpp.news"), "b.hpp.new" + std::to_string(gone)})
    std::ofstream(root_ / "out" / name) << "half of";
  write({{"a.hpp", ours}});
  EXPECT_FALSE(fs::exists(root_ / "out" / over));
  EXPECT_EQ(text(in_use), "half of");
  EXPECT_EQ(count(), 4u);  // with a.hpp
}

// A device or a pipe, by itself or behind a link.
TEST_F(OutputFiles, ThatAreNoneOfADiskStay) {
  fs::create_directories(root_ / "out");
  const std::string pipe = (root_ / "out/a.hpp").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("a.hpp", root_ / "out/b.hpp");
  for (const char* name : {"a.hpp", "b.hpp"}) {
    std::string got;
    std::thread reader([&] {
      std::ifstream file(pipe);
      got.assign(std::istreambuf_iterator<char>(file), {});
    });
    write({{name, ours + name}, {"c.hpp", ours}});
    reader.join();
    EXPECT_EQ(got, ours + name);
    EXPECT_TRUE(fs::is_fifo(pipe));
    EXPECT_EQ(text("c.hpp"), ours);
    EXPECT_EQ(count(), 3u);
  }
}

TEST(Json, StringsAreEscaped) {
  EXPECT_EQ(json_string("plain"), "\"plain\"");
  EXPECT_EQ(json_string("a\"b\\c\n\x01"), "\"a\\\"b\\\\c\\u000a\\u0001\"");
  EXPECT_EQ(json_string("g\xc3\xa9"), "\"g\xc3\xa9\"");
  for (const char* text : {"", "a\"b\\c\n\x01", "g\xc3\xa9"}) EXPECT_EQ(text_of_json_string(json_string(text)), text);
  EXPECT_EQ(json_string("\xc3(\xed\xa0\x80"), "\"\\ufffd(\\ufffd\\ufffd\\ufffd\"");  // not UTF-8
  EXPECT_EQ(json_array({"a", "b"}), "[\"a\", \"b\"]");
  EXPECT_EQ(json_array({}), "[]");
}

}  // namespace
}  // namespace dalembert
