// SPDX-License-Identifier: MIT
// Orders of reflection: colours of paths and stems, and which of them are shown.
import { css, order_color } from "../colors";
import { el, replace_children } from "../dom";
import { current_pair, order_name, orders_of, type Report } from "../report";
import { on_scheme_change, scheme } from "../theme";

/** Check boxes of the orders, which are the legend of paths and stems too. */
export function order_legend(report: Report): HTMLElement {
    const place = el("fieldset", { class: "legend orders" });
    const draw = (): void => {
        const { hidden_orders } = report.state.now;
        const paths = current_pair(report)?.paths ?? [];
        replace_children(place, el("legend", {}, "Orders of reflection"), ...orders_of(paths).map((order) => {
            const input = el("input", { type: "checkbox", checked: !hidden_orders.has(order), "data-order": order });
            input.addEventListener("change", () => {
                const hidden = new Set(report.state.now.hidden_orders);
                if (input.checked) {
                    hidden.delete(order);
                } else {
                    hidden.add(order);
                }
                report.state.set({ hidden_orders: hidden });
            });
            const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
            swatch.style.backgroundColor = css(order_color(order, scheme()));
            const count = paths.filter((p) => p.order === order).length;
            return el("label", { class: "check" }, input, swatch, `${order_name(order)} (${count})`);
        }));
    };
    draw();
    report.state.subscribe(["pair"], draw);
    report.state.subscribe(["hidden_orders"], () => place.querySelectorAll("input").forEach((input) => {
        input.checked = !report.state.now.hidden_orders.has(Number(input.dataset["order"]));
    }));
    on_scheme_change(draw);
    return place;
}
