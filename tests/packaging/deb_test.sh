#!/bin/sh
# sh deb_test.sh BUILD PROJECT PYTHON   Makes the Debian package, lets lintian judge it, installs it below a clean root, and uses it from
# there: a project in CMake and the first program in Python, while neither the source tree nor the build is to be seen. 77: this
# machine lacks what that takes.
set -eu
build=$1 project=$2 python=$3
for tool in lintian dpkg-deb dpkg-shlibdeps unshare; do
  command -v $tool > /dev/null || { echo "there is no $tool"; exit 77; }
done
unshare -rm true 2> /dev/null || { echo "no namespaces of one's own here"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/var/tmp}/dalembert.deb.XXXXXX")
trap 'rm -rf "$work"' EXIT

echo "== Package"
(cd "$build" && cpack -G DEB -B "$work/package" > "$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; exit 1; }
deb=$(echo "$work"/package/*.deb)
lintian --allow-root "$deb" > "$work/lintian.log" 2>&1 || true
cat "$work/lintian.log"
if grep -q '^E:' "$work/lintian.log"; then echo "lintian finds errors"; exit 1; fi

echo "== Installation"
# Debian's own account of what is installed, so that what the package depends on is looked for; its files alone lie below the root.
mkdir -p "$work/root/var/lib/dpkg/info" "$work/root/var/lib/dpkg/updates" "$work/root/var/lib/dpkg/triggers"
cp /var/lib/dpkg/status "$work/root/var/lib/dpkg/"
unshare -r dpkg --root="$work/root" --no-triggers --log=/dev/null -i "$deb" > "$work/dpkg.log" 2>&1 ||
  { grep -v "files list file" "$work/dpkg.log"; exit 1; }
test -x "$work/root/usr/bin/dalembert"

echo "== Use"
mkdir "$work/upper" "$work/home"
cat > "$work/use.sh" << 'END'
set -eu
work=$1 build=$2 project=$3 python=$4
mount -t overlay overlay -o "lowerdir=$work/root/usr:/usr" /usr
mount -t tmpfs hidden "$project"
if [ -d "$build" ]; then mount -t tmpfs hidden "$build"; fi
if [ -e "$project/CMakeLists.txt" ]; then echo "the source tree is still there"; exit 1; fi
unset PYTHONPATH CMAKE_PREFIX_PATH DALEMBERT_EXECUTABLE DALEMBERT_INCLUDE XDG_CACHE_HOME
export HOME="$work/home"
cd "$HOME"
test "$(command -v dalembert)" = /usr/bin/dalembert
dalembert --version
examples=/usr/share/doc/dalembert/examples
cp -r $examples/user_project .
cmake -S user_project -B built -DCMAKE_BUILD_TYPE=Debug > configure.log || { cat configure.log; exit 1; }
cmake --build built > build.log || { cat build.log; exit 1; }
built/two_robots
$python -c 'import dalembert; assert dalembert.__file__.startswith("/usr/lib/python3/"), dalembert.__file__'
$python $examples/python/first_steps.py "$HOME"
if [ -e /usr/lib/dalembert/readers/dalembert_sdf.so ]; then  # built where libsdformat was
  cat > one.sdf << 'SDF'
<sdf version="1.9"><model name="one"><link name="base"><inertial><mass>1</mass></inertial></link>
<link name="arm"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
<joint name="turn" type="revolute"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>
SDF
  dalembert info one.sdf --base fixed > info.txt
  grep -q turn info.txt
fi
test -s /usr/share/man/man1/dalembert.1.gz
bash -c '. /usr/share/bash-completion/completions/dalembert; complete -p dalembert'
END
unshare -rm sh "$work/use.sh" "$work" "$build" "$project" "$python"
