"use strict";
const m = JSON.parse(document.getElementById("moments").textContent), n = m.t.length;
const part = name => document.getElementById(name), when = part("when"), play = part("play");
const low = Math.min(0, ...m.v), high = Math.max(0, ...m.v), scale = 170 / (high - low || 1);
const across = i => 640 * i / (n - 1), up = v => 180 - (v - low) * scale;
const reach = Math.max(...m.xi.map(Math.abs), ...m.x.map(Math.abs)) || 1, zoom = 110 / reach;
part("line").setAttribute("points", m.v.map((v, i) => across(i).toFixed(1) + "," + up(v).toFixed(1)).join(" "));
for (const end of ["y1", "y2"]) part("zero").setAttribute(end, up(0));
function show(i) {
  const at = 320 + zoom * m.x[i];
  part("body").setAttribute("transform", `translate(${at} 0)`);
  part("mass").setAttribute("transform", `translate(${at + zoom * m.xi[i]} 0)`);
  part("cursor").setAttribute("x1", across(i)); part("cursor").setAttribute("x2", across(i));
  part("dot").setAttribute("cx", across(i)); part("dot").setAttribute("cy", up(m.v[i]));
  part("told").textContent = `t = ${m.t[i].toFixed(2)} ms, v = ${m.v[i].toFixed(3)} mm/s, x = ${m.x[i].toFixed(4)} mm, friction ${m.R[i].toFixed(4)} N`;
}
let timer = null;
function step() { when.value = (Number(when.value) + 2) % n; show(Number(when.value)); timer = requestAnimationFrame(step); }
play.addEventListener("click", () => {
  if (timer === null) { play.textContent = "Pause"; step(); } else { cancelAnimationFrame(timer); timer = null; play.textContent = "Play"; }
});
when.addEventListener("input", () => show(Number(when.value)));
show(0);
