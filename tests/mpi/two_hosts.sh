#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# two_hosts.sh PROGRAM STUDY [RUNS]: mpirun on two hosts, which are two network namespaces with a name, an address and a
# wire of their own: the same bytes as one process of what compare, tune, train and learn write, of a study with a correction
# "nfnn" that the repository has; and a clear end within 10 s where a rank is killed or the wire is cut. Prints the times of
# one process and of one rank on each host. Status 77 where this machine permits no namespaces or has no mpirun.
set -uo pipefail
program=$(realpath "$1") study=$(realpath "$2") runs=${3-400}
skip() { echo "two_hosts: left out: $1"; exit 77; }
fail() { echo "two_hosts: $1" >&2; exit 1; }
command -v mpirun >/dev/null || skip "no mpirun"
command -v ip >/dev/null || skip "no ip"
a=tb-a-$$ b=tb-b-$$ scratch=$(mktemp -d)
end() {
  ip netns delete "$a" 2>/dev/null
  ip netns delete "$b" 2>/dev/null
  rm -rf "$scratch"
}
trap end EXIT
ip netns add "$a" 2>/dev/null && ip netns add "$b" 2>/dev/null && unshare --uts true 2>/dev/null || skip "no namespaces"
ip -n "$a" link add wire type veth peer name wire netns "$b" 2>/dev/null || skip "no wire between namespaces"
for side in "$a 1" "$b 2"; do
  read -r name number <<<"$side"
  ip -n "$name" address add "10.77.0.$number/24" dev wire
  ip -n "$name" link set wire up
  ip -n "$name" link set lo up
done

# on NAMESPACE COMMAND...: there, under a host name of its own.
on() { ip netns exec "$1" unshare --uts bash -c 'hostname "$0" && exec "$@"' "$@"; }
# What mpirun starts its other host with: no ssh, but the other namespace.
cat >"$scratch/agent" <<END
#!/bin/bash
exec ip netns exec $b unshare --uts bash -c 'hostname $b && eval "\$0"' "\${*:2}"
END
chmod +x "$scratch/agent"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 TMPDIR=$scratch
two_hosts() {
  on "$a" mpirun --mca plm_rsh_agent "$scratch/agent" --mca pml ob1 --mca btl tcp,self --mca btl_tcp_if_include 10.77.0.0/24 \
    --mca oob_tcp_if_include 10.77.0.0/24 --mca orte_keep_fqdn_hostnames 1 --bind-to none -n 2 --host 10.77.0.1:1,10.77.0.2:1 "$@"
}
now_ms() { echo $((${EPOCHREALTIME/[.,]/} / 1000)); }
# timed COMMAND...: its time in ms as $took_ms.
timed() {
  local begin
  begin=$(now_ms)
  "$@" >"$scratch/said" 2>&1 || { cat "$scratch/said" >&2; fail "status not 0: $*"; }
  took_ms=$(($(now_ms) - begin))
}

two_hosts hostname | sort | tr '\n' ' ' | grep -q "$a $b" || fail "the ranks are not on two hosts"
compare=("$program" compare "$study" --threads 1 --quiet)
timed "${compare[@]}" --runs "$runs" --json "$scratch/one.json"; one=$took_ms
timed two_hosts "${compare[@]}" --runs "$runs" --json "$scratch/two.json"; two=$took_ms
for file in one two; do grep -v '"ns_per_step"' "$scratch/$file.json" >"$scratch/$file.figures"; done
cmp "$scratch/one.figures" "$scratch/two.figures" || fail "other bytes on two hosts"
echo "two_hosts: $runs runs: one process $one ms, one rank on each of two hosts $two ms, same bytes"

# What ranks tune and teach together is what one process does. Only the first says what it found, and writes.
for work in tune train; do
  command=("$work" "$study" --threads 1)
  if [[ $work == train ]]; then command+=(--tracker nfnn); fi
  timed "$program" "${command[@]}" -o "$scratch/one.made"; one=$took_ms
  mv "$scratch/said" "$scratch/one.said"
  timed two_hosts "$program" "${command[@]}" -o "$scratch/two.made"; two=$took_ms
  cmp "$scratch/one.made" "$scratch/two.made" || fail "other bytes of $work"
  for file in one.said said; do sed -E 's/[0-9.]+ s;|one.made|two.made//g' "$scratch/$file" >"$scratch/$file.text"; done
  cmp "$scratch/one.said.text" "$scratch/said.text" || fail "said otherwise by $work"
  echo "two_hosts: $work: one process $one ms, one rank on each of two hosts $two ms, same bytes"
done
for name in one two; do
  mkdir "$scratch/$name"
  command=("$program" learn "$study" --threads 1 --quiet -o "$scratch/$name" --json "$scratch/$name/learnt.json")
  if [[ $name == one ]]; then timed "${command[@]}"; else timed two_hosts "${command[@]}"; fi
  sed -i '/"ns_per_step"/d' "$scratch/$name/learnt.json"
done
diff -r "$scratch/one" "$scratch/two" || fail "other bytes of learn"
two_hosts "$program" compare "$study" --retrain --runs 20 --threads 1 --quiet --json "$scratch/retrained.json" >"$scratch/said" 2>&1 || fail "compare --retrain"
"$program" compare "$study" --retrain --runs 20 --threads 1 --quiet --json "$scratch/one.json" >/dev/null
cmp <(grep -v '"ns_per_step"' "$scratch/one.json") <(grep -v '"ns_per_step"' "$scratch/retrained.json") || fail "other bytes of compare --retrain"

# What is at fault is said once, by the first, whoever finds it.
two_hosts "$program" tune "$scratch/none.toml" >"$scratch/said" 2>&1 && fail "status 0 without a study"
(($(grep -c '^truebearing:' "$scratch/said") == 1)) || { cat "$scratch/said" >&2; fail "not one line on a missing study"; }

# Studies of other numbers, beside the scenarios and models that they name.
repository=$(dirname "$(realpath "$0")")/../..
mkdir -p "$scratch/data/studies"
ln -s "$(realpath "$repository/data/scenarios")" "$scratch/data/scenarios"
cp -r "$repository/models" "$scratch/models"
studies=$scratch/data/studies

# A motion that is learned is written before filters with it are corrected: all ranks read it then.
sed -E 's/^(runs|iterations) = .*/\1 = 20/' "$repository/data/studies/lorenz_mismatch.toml" >"$studies/motion.toml"
train=("$program" train "$studies/motion.toml" --tracker learned --tracker nfnn --threads 1 --quiet)
timed "${train[@]}"
cp -r "$scratch/models" "$scratch/models_of_one"
cp -r "$repository/models/." "$scratch/models"
timed two_hosts "${train[@]}"
diff -r "$scratch/models_of_one" "$scratch/models" || fail "other bytes with a learned motion"
cmp -s "$repository/models/lorenz_mismatch.learned.json" "$scratch/models/lorenz_mismatch.learned.json" && fail "no motion was learned"

# They tune, teach and train for more than ten seconds.
long_study() { sed -E "$2" "$study" >"$studies/$1.toml"; }
long_study tunes '/^\[tuning\]/,/^\[/s/^runs = .*/runs = 300000/'
long_study teaches '/^\[trackers.nfnn.training\]/,$s/^runs = .*/runs = 300000/'
long_study trains '/^\[trackers.nfnn.training\]/,$s/^iterations = .*/iterations = 100000/'

# ends_well WHAT COMMAND...: a long command on both hosts ends within 10 s of WHAT, in a line of ours, and leaves no output.
ends_well() {
  local what=$1 job begin took
  shift
  rm -f "$scratch/long.made"
  two_hosts "$program" "$@" --threads 1 --quiet >"$scratch/said" 2>&1 &
  job=$!
  sleep 2
  begin=$(now_ms)
  "$what"
  wait "$job" && fail "status 0 of $1 after $what"
  took=$(($(now_ms) - begin))
  ((took < 10000)) || fail "$took ms from $what to the end of $1"
  grep -q '^truebearing: mpirun: all ranks end, as one failed, was killed' "$scratch/said" || { cat "$scratch/said" >&2; fail "no line of $1 after $what"; }
  [[ ! -e $scratch/long.made ]] || fail "output of $1 after $what"
  echo "two_hosts: $1: $what: ended after $took ms"
}
kill_rank_on_b() {
  local pid
  for pid in $(ip netns pids "$b"); do
    if [[ $(readlink "/proc/$pid/exe") == "$program" ]]; then kill -KILL "$pid"; fi
  done
}
cut_wire() { ip -n "$b" link set wire down; for pid in $(ip netns pids "$b"); do kill -KILL "$pid"; done; }
ends_well kill_rank_on_b compare "$study" --runs 100000000 --json "$scratch/long.made"
ends_well kill_rank_on_b tune "$studies/tunes.toml" -o "$scratch/long.made"
ends_well kill_rank_on_b train "$studies/teaches.toml" --tracker nfnn -o "$scratch/long.made"
ends_well kill_rank_on_b train "$studies/trains.toml" --tracker nfnn -o "$scratch/long.made"
ends_well cut_wire compare "$study" --runs 100000000 --json "$scratch/long.made"
