//! Parts of a self-contained page, readable on light and dark screens.

use std::fmt::Write as _;

use crate::color;

/// A whole page; `body` is HTML, `title` is text.
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head>\n<body><main>\n{body}\n</main></body></html>\n",
        title = escape(title),
    )
}

/// Text as HTML.
pub fn escape(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            c => html.push(c),
        }
    }
    html
}

/// A section with a heading; nothing where there is no content.
pub fn section(heading: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!(
        "<section><h2>{}</h2>\n{content}</section>\n",
        escape(heading)
    )
}

/// A picture with a caption below.
pub fn figure(address: &str, caption: &str) -> String {
    let caption = escape(caption);
    format!("<figure><img src=\"{address}\" alt=\"{caption}\" loading=\"lazy\"><figcaption>{caption}</figcaption></figure>")
}

/// A table of names and values.
pub fn table(rows: impl IntoIterator<Item = (String, String)>) -> String {
    let mut html = String::from("<table>");
    for (name, value) in rows {
        let _ = write!(
            html,
            "<tr><th>{}</th><td>{}</td></tr>",
            escape(&name),
            escape(&value)
        );
    }
    html.push_str("</table>\n");
    html
}

/// The colours of a heat map and what its ends mean.
pub fn heat_legend(low: &str, high: &str) -> String {
    let stops = color::HEAT_STOPS.map(color::hex).join(",");
    format!(
        "<p class=\"legend\"><span>{}</span><i style=\"background:linear-gradient(90deg,{stops})\"></i><span>{}</span></p>",
        escape(low),
        escape(high)
    )
}

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1d2430;--soft:#5f6b7a;--paper:#fbfbf9;--card:#fff;--line:#dfe3e8;--accent:#1f7a6d;--bad:#b3261e}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ee;--soft:#98a3b3;--paper:#14171c;--card:#1c2128;--line:#303742;--accent:#5cc4b0;--bad:#ff8a80}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:15px/1.5 system-ui,sans-serif}
main{max-width:1280px;margin:0 auto;padding:28px 24px 64px}
h1{font-size:26px;font-weight:650;margin:0 0 4px}h2{font-size:17px;font-weight:650;margin:36px 0 12px}
p{margin:4px 0}.soft,figcaption,small{color:var(--soft)}.bad{color:var(--bad)}.good{color:var(--accent)}
.cards{display:flex;flex-wrap:wrap;gap:12px;margin:20px 0}
.card{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:12px 16px;min-width:132px}
.card b{display:block;font-size:22px;font-weight:600;font-variant-numeric:tabular-nums}
.card span{color:var(--soft);font-size:13px}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(220px,1fr));gap:12px}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:10px;padding:10px}
figure img{display:block;width:100%;height:auto}figcaption{font-size:13px;text-align:center;margin-top:6px}
.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(200px,1fr));gap:12px}
.chart figcaption{text-align:left;margin:0 0 6px;color:var(--ink)}
.chart svg{display:block;width:100%;height:96px;overflow:visible}
.chart path{fill:none;vector-effect:non-scaling-stroke}.chart .axis{stroke:var(--line)}.chart .curve{stroke:var(--accent);stroke-width:1.5}
.chart p{display:flex;justify-content:space-between;font-size:12px;color:var(--soft);font-variant-numeric:tabular-nums}
.chart p span:first-child::before{content:'max '}.chart p span:nth-child(2)::before{content:'min '}.chart p span:last-child::after{content:' iterations'}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{text-align:left;font-weight:400;padding:4px 18px 4px 0;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--soft)}td.n,th.n{text-align:right}
td img{display:block;width:110px;height:auto}
.bar{display:inline-block;height:8px;border-radius:4px;background:var(--accent);vertical-align:middle;margin-right:8px}
.legend{display:flex;align-items:center;gap:10px;font-size:13px;color:var(--soft);margin-top:10px}
.legend i{width:180px;height:10px;border-radius:5px}
pre{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:14px 16px;overflow:auto;font:13px/1.45 ui-monospace,monospace}
details summary{cursor:pointer;color:var(--soft)}
ul{margin:4px 0;padding-left:20px}
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_from_files_cannot_break_the_page() {
        let html = page("<a>", &table([("x<y".to_owned(), "\"&\"".to_owned())]));
        assert!(html.contains("<title>&lt;a&gt;</title>") && html.contains("x&lt;y"));
        assert!(html.contains("&quot;&amp;&quot;"));
    }

    #[test]
    fn empty_sections_vanish() {
        assert!(section("Curves", "").is_empty());
        assert!(section("Curves", "x").contains("<h2>Curves</h2>"));
    }

    #[test]
    fn the_legend_shows_every_stop() {
        let html = heat_legend("0", "1 %");
        assert!(color::HEAT_STOPS
            .map(color::hex)
            .iter()
            .all(|stop| html.contains(stop)));
    }
}
