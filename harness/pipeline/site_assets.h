// Style and script of the leaderboard's site (board_site.h), as they stand inside each of its pages.
#pragma once

#include <string_view>

namespace touchstone::pipeline {

// Colours of Okabe and Ito, which the colour-blind tell apart. Below 600 px a row of a table is a card.
inline constexpr std::string_view site_style = R"css(
:root{--ink:#1b1f24;--soft:#5d6670;--line:#d5dae0;--back:#fff;--card:#f6f8fa;--blue:#0072b2;--orange:#d55e00;--green:#009e73}
@media (prefers-color-scheme:dark){:root{--ink:#e6e9ed;--soft:#9aa4af;--line:#39424c;--back:#14181d;--card:#1d232a;--blue:#56b4e9;--orange:#e69f00;--green:#2fc79c}}
*{box-sizing:border-box}
body{margin:0;background:var(--back);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:48rem;margin:0 auto;padding:1rem}
h1{font-size:1.6rem;line-height:1.2}h2{font-size:1.2rem;margin:2rem 0 .3rem}h3{font-size:1rem}
p{margin:.4rem 0}h1,h2,p,li,td,a{overflow-wrap:anywhere;min-width:0}.about,.facts,footer,small{color:var(--soft);font-size:.85rem}small{display:block}
nav{display:flex;flex-wrap:wrap;gap:.3rem .9rem}a{color:var(--blue)}
table{width:100%;border-collapse:collapse;margin:.6rem 0;font-size:.92rem}
th,td{padding:.3rem .45rem;border-bottom:1px solid var(--line);text-align:right;vertical-align:top}
th:nth-child(-n+2),td:nth-child(-n+2),td.why{text-align:left}
th button{all:unset;cursor:pointer;font-weight:600}th button:focus-visible{outline:2px solid var(--blue)}
th[aria-sort=ascending] button::after{content:" \2191"}th[aria-sort=descending] button::after{content:" \2193"}
tr.out{color:var(--soft)}code{font-size:.8rem;overflow-wrap:anywhere}
svg.picture{display:block;width:100%;height:auto;background:var(--card);border-radius:6px;margin:.6rem 0}
svg text{font:12px system-ui,sans-serif;fill:var(--ink)}
.grid{stroke:var(--line)}.axis{stroke:var(--soft)}.interval{stroke:var(--blue);stroke-width:3}.dot{fill:var(--blue)}
.beaten{fill:var(--soft)}.floor{stroke:var(--green);stroke-width:2;stroke-dasharray:5 3}
.measured{stroke:var(--orange);stroke-width:2;stroke-dasharray:2 3}.group{stroke:var(--ink);stroke-width:4}
.front{fill:none;stroke:var(--blue);stroke-dasharray:4 3}
@media (max-width:600px){svg text{font-size:19px}
thead{display:block}thead tr{display:flex;flex-wrap:wrap;gap:.2rem 1rem;border-bottom:1px solid var(--line);padding:.3rem 0}
th{display:block;border:0;padding:.2rem 0}tbody{display:block}
tbody tr{display:grid;grid-template-columns:1fr 1fr;gap:0 1.4rem;padding:.4rem 0;border-bottom:1px solid var(--line)}
td:nth-child(2){grid-column:1/-1;order:-1}td:nth-child(2)::before{display:none}td.why{grid-column:1/-1}
td{display:flex;justify-content:space-between;gap:.6rem;border:0;padding:.1rem 0;text-align:right}
td::before{content:attr(data-label);color:var(--soft);text-align:left}td:nth-child(2){font-weight:600}td.why{display:block}}
)css";

// A click on a head sorts by its column, a second one the other way round; rows without a number stay last.
inline constexpr std::string_view site_script = R"js(
'use strict';
for (const table of document.querySelectorAll('table')) {
  const heads = [...table.querySelectorAll('th')];
  heads.forEach((head, column) => head.querySelector('button').addEventListener('click', () => {
    const down = head.getAttribute('aria-sort') === 'ascending';
    heads.forEach((other) => other.removeAttribute('aria-sort'));
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const body = table.tBodies[0];
    const key = (row) => {
      const cell = row.cells[column];
      if (column === 1) return cell.textContent;
      return cell && cell.dataset.value ? Number(cell.dataset.value) : null;
    };
    [...body.rows].sort((a, b) => {
      const [x, y] = [key(a), key(b)];
      if (x === null || y === null) return (x === null) - (y === null);
      return (down ? -1 : 1) * (x < y ? -1 : x > y ? 1 : 0);
    }).forEach((row) => body.append(row));
  }));
}
const pictures = document.querySelectorAll('svg.picture');
window.touchstoneReport = { ready: true, plots: pictures.length, drawn: pictures.length, failures: [] };
)js";

}  // namespace touchstone::pipeline
