// SPDX-License-Identifier: MIT
#include "experiment/report/page_style.hpp"

namespace seqloop::experiment {

const char* page_style_sheet() {
  return R"(
:root { --paper: #ffffff; --ink: #1d1f21; --soft: #5c6167; --rule: #d5d9dd; --band: #f4f6f8;
  --link: #0a5aa8; }
@media screen and (prefers-color-scheme: dark) {
  :root { --paper: #16191d; --ink: #eceef0; --soft: #a4abb3; --rule: #3a4047; --band: #1f2429;
    --link: #7fbcff; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1288px; padding: 2rem 1.25rem 4rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 Arial, "Liberation Sans", Helvetica, sans-serif;
  overflow-wrap: break-word; }
header .note { max-width: none; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 0.5rem; }
h2 { font-size: 1.35rem; margin: 2.75rem 0 0.9rem; padding-top: 0.9rem;
  border-top: 2px solid var(--ink); }
h3 { font-size: 1.02rem; line-height: 1.35; margin: 0 0 0.4rem; }
p { margin: 0 0 0.7rem; max-width: 46rem; }
a { color: var(--link); }
.note { color: var(--soft); font-size: 0.86rem; }
figure { margin: 0; min-width: 0; }
.panels { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 380px), 1fr));
  gap: 1.5rem; margin-bottom: 2.75rem; }
.panels .wide { grid-column: 1 / -1; }
.panels .chart { display: block; width: 100%; max-width: 392px; height: auto; }
.scroll { overflow-x: auto; margin: 0 0 2.25rem; }
table { border-collapse: collapse; font-size: 0.88rem; font-variant-numeric: tabular-nums;
  border-bottom: 1px solid var(--ink); }
caption { text-align: left; padding-bottom: 0.3rem; }
caption p { margin: 0 0 0.3rem; }
caption div { display: inline-block; position: sticky; left: 0; max-width: calc(100vw - 2.5rem); }
th, td { padding: 0.22rem 0.7rem; line-height: 1.4; white-space: nowrap; vertical-align: top; }
th { font-weight: normal; text-align: left; }
thead th { color: var(--soft); vertical-align: bottom; border-bottom: 1px solid var(--ink);
  border-top: 1px solid var(--rule); }
th.n { text-align: right; }
th.n[colspan] { text-align: center; }
.group th { padding-top: 0.8rem; font-weight: bold; }
td { text-align: right; }
tr.first th, tr.first td { border-top: 1px solid var(--rule); }
tbody tr:hover td { background: var(--band); }
.matrices { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 300px), 1fr));
  gap: 1.5rem; }
.matrices img { display: block; width: 100%; height: auto; margin-bottom: 0.5rem;
  border: 1px solid var(--rule); }
.matrices p { color: var(--soft); font-size: 0.88rem; margin: 0.2rem 0 0; }
summary { cursor: pointer; margin-bottom: 0.8rem; }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: 0.3rem 1.25rem;
  margin: 0; font-size: 0.92rem; }
dt { color: var(--soft); }
dd { margin: 0; }
@media (max-width: 600px) {
  body { padding: 1.25rem 1rem 3rem; }
  table { font-size: 0.8rem; }
  th, td { padding: 0.22rem 0.4rem; }
}
@media (min-width: 860px) { .panels .chart ~ .chart .axis-title { display: none; } }
@media print {
  body { max-width: none; padding: 0; font-size: 11pt; }
  .panels .chart, tr, .matrices figure { break-inside: avoid; }
  .scroll { overflow: visible; }
}
)";
}

}  // namespace seqloop::experiment
